// A long list of rows of one height, of which only those in sight are in the page. The list is one
// stop of the Tab key; up and down go from row to row.

import { allIn, element, refill, targetOf } from "./dom.js";

const ROWS_BEYOND = 4;

export class Rows {
  // `make(looks, index, count)` makes a row of what `build(item)` says of it: {row, button, placed}.
  constructor(/** @type {HTMLElement} */ box, /** @type {(looks: any, index: number, count: number) => any} */ make = listRow) {
    this.box = box;
    this.make = make;
    this.sizer = element("div", { class: "sizer", role: make === listRow ? "list" : "rowgroup" });
    box.append(this.sizer);
    /** @type {any[]} */ this.items = [];
    this.height = 1; // of a row, in pixels
    /** @type {((item: any) => any) | null} */ this.build = null;
    this.stop = 0; // the row that Tab leads to
    this.top = this.high = 0; // what is in sight, in pixels: asking the box would lay it out anew
    box.addEventListener("scroll", () => {
      if (box.scrollTop === this.top) return;
      this.top = box.scrollTop;
      this.fill();
    });
    this.sizer.addEventListener("keydown", (event) => this.press(event));
    this.sizer.addEventListener("focusin", (event) => this.moveStop(targetOf(event)));
    new ResizeObserver(() => this.seen(box.clientHeight)).observe(box);
  }

  // Show items, the one with the number `shown` in sight unless that is null.
  show(/** @type {any[]} */ items, height, build, emptyText, /** @type {number | null} */ shown = null) {
    Object.assign(this, { items, height, build });
    this.sizer.style.height = `${items.length * height}px`;
    this.sizer.hidden = !items.length;
    this.empty?.remove();
    this.empty = items.length ? null : element("p", { class: "empty" }, emptyText);
    if (this.empty) this.box.append(this.empty);
    this.high ||= this.box.clientHeight;
    if (shown !== null) this.reveal(shown);
    this.top = Math.max(0, Math.min(this.top, items.length * height - this.high));
    this.fill();
  }

  seen(high) {
    this.high = high;
    this.fill();
  }

  fill() {
    if (!this.build) return;
    const first = Math.max(0, Math.floor(this.top / this.height) - ROWS_BEYOND);
    const inSight = Math.ceil(this.high / this.height) + 2 * ROWS_BEYOND;
    const last = Math.min(this.items.length, first + inSight) - 1;
    const stop = Math.max(first, Math.min(last, this.stop));
    const nodes = [];
    for (let index = first; index <= last; index++) nodes.push(this.row(index, index === stop));
    refill(this.sizer, nodes);
  }

  row(index, isStop) {
    const { row, button, placed } = this.make(this.build?.(this.items[index]), index, this.items.length);
    button.dataset.key = String(index);
    button.tabIndex = isStop ? 0 : -1;
    placed.style.top = `${index * this.height}px`;
    placed.style.height = `${this.height}px`;
    return row;
  }

  press(/** @type {KeyboardEvent} */ event) {
    const by = { ArrowUp: -1, ArrowDown: 1 }[event.key];
    if (!by) return;
    event.preventDefault();
    event.stopPropagation();
    const next = Math.max(0, Math.min(this.items.length - 1, this.stop + by));
    this.keepInSight(next);
    this.fill();
    allIn(this.sizer, `[data-key="${next}"]`)[0]?.focus({ preventScroll: true });
  }

  moveStop(button) {
    for (const before of allIn(this.sizer, "[tabindex='0']")) before.tabIndex = -1;
    button.tabIndex = 0;
    this.stop = Number(button.dataset.key);
  }

  toTop() {
    this.stop = 0;
    this.top = this.box.scrollTop = 0;
  }

  // Scroll no further than needed.
  keepInSight(index) {
    const top = index * this.height;
    const least = top + this.height - this.high;
    this.top = this.box.scrollTop = Math.max(0, Math.min(top, Math.max(this.top, least)));
  }

  // Bring an item near the middle unless it is in sight.
  reveal(index) {
    const top = index * this.height;
    if (top >= this.top && top + this.height <= this.top + this.high) return;
    const most = this.items.length * this.height - this.high;
    this.top = Math.round(Math.max(0, Math.min(most, top - this.high / 2)));
    this.box.scrollTop = this.top;
  }
}

// A row that is one button: of {class, title, children, on}.
function listRow({ class: kind, title, children, on }, index, count) {
  const button = element("button", { type: "button", class: `row ${kind ?? ""}`, title: title ?? "", on }, ...children);
  const row = element("div", { role: "listitem", "aria-setsize": count, "aria-posinset": index + 1 }, button);
  return { row, button, placed: button };
}
