// A table of all tasks or all robots: sorted by a column, filtered by any word, saved as CSV.

import { element, refill } from "../panel/dom.js";
import { Rows } from "../panel/rows.js";
import { csvOf, download, fileName } from "../panel/saving.js";
import { plural } from "../record/lengths.js";
import { momentOf, wholeText } from "./columns.js";

const TABLE_ROW = 32; // pixels

export class Table {
  // `kind` is "task" or "robot", as in a selection.
  constructor(/** @type {App} */ app, /** @type {"task" | "robot"} */ kind, /** @type {Column[]} */ columns, /** @type {HTMLElement} */ box) {
    this.app = app;
    this.kind = kind;
    this.columns = columns;
    /** @type {{item: number, cells: Cell[]}[]} */ this.items = [];
    /** @type {Column[]} */ this.shown = [];
    /** @type {{column: string | null, down: boolean}} */ this.sorted = { column: null, down: false }; // as in the file until a column is chosen
    this.filter = element("input", { type: "search", placeholder: "Filter", "aria-label": `Filter the ${kind}s` });
    this.filter.addEventListener("input", () => this.show());
    this.said = element("span", { role: "status" });
    this.head = element("div", { role: "row", class: "cells head" });
    this.scroll = element("div", { class: "rows" });
    this.table = element("div", { role: "table", class: "table", "aria-label": `All ${kind}s` }, element("div", { role: "rowgroup" }, this.head), this.scroll);
    const save = element("button", { type: "button", on: () => this.save() }, "Save as CSV");
    box.replaceChildren(element("div", { class: "table-tools" }, this.filter, this.said, save), element("div", { class: "across" }, this.table));
    this.rows = new Rows(this.scroll, tableRow);
  }

  // The table as it is at this moment.
  show() {
    const { app, kind } = this;
    const { mission } = app.history;
    this.shown = this.columns.filter(({ isShown }) => isShown?.(mission) ?? true);
    const moment = momentOf(app);
    const items = this.ordered(this.cellsOf(moment));
    this.items = items;
    const total = mission[`${kind}s`].length;
    this.said.textContent = items.length < total ? `${items.length} of ${total}` : plural(total, kind);
    this.table.className = `table ${kind}s ${this.shown.length > 5 ? "wide" : ""}`;
    this.table.setAttribute("aria-rowcount", String(items.length + 1));
    refill(this.head, this.shown.map((column) => this.headCell(column)));
    this.rows.show(items, TABLE_ROW, (item) => this.row(item), `No such ${kind}.`);
  }

  // [{item, cells}] of those that the filter lets through.
  cellsOf(/** @type {Moment} */ moment) {
    const wanted = this.filter.value.trim().toLowerCase();
    const all = moment.mission[`${this.kind}s`].map((_, item) => ({
      item,
      cells: this.shown.map(({ of }) => of(moment, item)),
    }));
    return all.filter(({ cells }) => !wanted || cells.some((cell) => wholeText(cell).toLowerCase().includes(wanted)));
  }

  ordered(rows) {
    const at = this.shown.findIndex(({ name }) => name === this.sorted.column);
    if (at < 0) return rows;
    const sign = this.sorted.down ? -1 : 1;
    const keyOf = ({ cells }) => cells[at].sort;
    return rows.sort((one, other) => compareKeys(keyOf(one), keyOf(other), sign) || one.item - other.item);
  }

  headCell({ name }) {
    const { column, down } = this.sorted;
    const isSorted = name === column;
    const sort = isSorted ? (down ? "descending" : "ascending") : "none";
    const sign = element("span", { "aria-hidden": "true" }, isSorted ? (down ? " ↓" : " ↑") : "");
    const button = element("button", { type: "button", on: () => this.sortBy(name), "data-key": name }, name, sign);
    return element("div", { role: "columnheader", "aria-sort": sort }, button);
  }

  // Once up, once down, then as in the file.
  sortBy(name) {
    const { column, down } = this.sorted;
    if (name !== column) this.sorted = { column: name, down: false };
    else this.sorted = down ? { column: null, down: false } : { column: name, down: true };
    this.rows.toTop();
    this.show();
  }

  row({ item, cells }) {
    const { app, kind } = this;
    return { class: app.selection[kind] === item ? "now" : "", cells, on: () => app.select({ [kind]: item }) };
  }

  // What the table shows, in its order; each cell has all that it says.
  save() {
    const rows = [this.shown.map(({ name }) => name), ...this.items.map(({ cells }) => cells.map(wholeText))];
    const name = `${fileName(this.app.history.mission.name)}-${this.kind}s-${this.app.player.step}.csv`;
    download(csvOf(rows), name);
  }
}

// Numbers before words, nothing last, whichever way it is sorted.
function compareKeys(one, other, sign) {
  if (one === null || other === null) return Number(one === null) - Number(other === null);
  if (typeof one !== typeof other) return typeof one === "number" ? -1 : 1;
  return sign * (typeof one === "number" ? one - other : one.localeCompare(other, undefined, { numeric: true }));
}

// A row whose first cell is the button that selects it.
function tableRow({ class: kind, cells, on }, index) {
  const button = element("button", { type: "button", class: "link" }, cells[0].text);
  const others = cells.slice(1).map((cell) => {
    const looks = [cell.isAhead ? "ahead" : "", cell.isBad ? "bad" : ""].join(" ");
    return element("div", { role: "cell", class: looks, title: wholeText(cell) }, cell.text);
  });
  const first = element("div", { role: "rowheader", title: cells[0].text }, button);
  const looks = { class: `cells ${kind}`, "aria-current": String(kind === "now") };
  const row = element("div", { role: "row", ...looks, "aria-rowindex": index + 2, on }, first, ...others);
  return { row, button, placed: row };
}
