// Records in step: their table and their curves in the panel, and how their maps are laid out.

import { PHONE, scaleToFit } from "../draw/camera.js";
import { byId, element, oneStop, refill } from "../panel/dom.js";
import { costOf, isWeighed, missedWeight, weighedValue } from "../record/costs.js";
import { describeAmount } from "../record/lengths.js";
import { hasDueTimes } from "../record/mission.js";
import { countDone } from "../record/scene.js";
import { Curves } from "./curves.js";
import { recordColour, recordItem, titleOf } from "./titles.js";

export const MOST_MAPS = 6; // beside each other; further records are rows of the table

export class Compared {
  constructor(/** @type {App} */ app, /** @type {HTMLElement} */ box) {
    this.app = app;
    this.box = box;
    this.table = element("div", {});
    this.canvas = element("canvas", { class: "curves", role: "img", "aria-label": "Tasks done over time; the table says the same in numbers" });
    box.append(element("h2", {}, "Compared"), this.canvas, this.table);
    this.curves = new Curves(app, this.canvas);
    new ResizeObserver(() => this.layMaps()).observe(byId("stage-map"));
  }

  show() {
    const { trials, failed } = this.app;
    this.box.hidden = trials.length + failed.length < 2;
    byId("caption").hidden = trials.length < 2;
    if (this.box.hidden) return;
    byId("caption").replaceChildren(...recordItem(this.app).childNodes);
    const measures = measuresOf(trials);
    const head = ["method", "done", ...measures.columns.map(({ name }) => name), "to best"];
    const rows = trials.map((trial) => comparedRow(this.app, trial, measures));
    const header = element("thead", {}, element("tr", {}, ...head.map((text) => element("th", { scope: "col" }, text))));
    refill(this.table, [oneStop(element("table", {}, header, element("tbody", {}, ...rows, ...failed.map((failure) => failedRow(failure, head.length)))))]);
    this.curves.draw();
  }

  // As many columns as make the maps largest: of wide worlds one, so that they lie under each other.
  layMaps() {
    const { app } = this;
    const { clientWidth: width, clientHeight: height } = byId("stage-map");
    const count = 1 + app.companions.length;
    const columns = width > PHONE ? columnsFor(count, app.history.mission.world.used, width, height) : 1;
    byId("stage-map").style.gridTemplateColumns = `repeat(${columns}, minmax(0, 1fr))`;
    this.placeCurves(width > 0 && count % columns > 0);
  }

  // Where maps leave a part of the stage empty, the curves are there, else in the panel.
  placeCurves(isRoom) {
    if (isRoom) byId("stage-map").append(this.canvas);
    else if (this.canvas.parentElement !== this.box) this.box.insertBefore(this.canvas, this.table);
  }
}

// The number of columns in which so many maps of a world are largest in a box.
function columnsFor(count, used, width, height) {
  const scale = (columns) => scaleToFit(used, width / columns, height / Math.ceil(count / columns));
  const all = Array.from({ length: count }, (_, index) => index + 1);
  return all.reduce((best, columns) => (scale(columns) > scale(best) ? columns : best));
}

// What records are compared by: the columns that tell of it, and `judge`, what a record is judged by.
// Where all missions are judged by more than the makespan, as plans of them are, records are, too. Without
// a cost what was missed counts first.
function measuresOf(/** @type {Trial[]} */ trials) {
  const has = (isTrue) => trials.length > 0 && trials.every(({ history }) => isTrue(history.mission));
  const columns = [{ name: "makespan", of: describeMakespan }];
  if (has(({ cost }) => cost)) columns.push({ name: "cost", of: describeCost });
  if (trials.some(({ history }) => hasDueTimes(history.mission))) columns.push({ name: "late", of: describeAllLate });
  if (trials.some(({ history }) => history.record.mission.until !== undefined)) columns.push({ name: "missed", of: (history) => String(missedWeight(history)) });
  const missed = (history) => (history.mission.cost ? 0 : missedWeight(history));
  const judge = has(isWeighed) ? weighedValue : ({ end }) => end.makespan;
  return { columns, judge, missed };
}

function describeMakespan(/** @type {TrialHistory} */ { mission, end: { makespan, status } }) {
  return makespan === null ? status : describeAmount(mission.world, makespan);
}

function describeCost(/** @type {TrialHistory} */ history) {
  const cost = costOf(history);
  return cost === null ? "" : String(Number(cost.toPrecision(6)));
}

// How many tasks were late, and by how much in all.
function describeAllLate(/** @type {TrialHistory} */ { mission, doneAt }) {
  const late = mission.tasks.map(({ due }, task) => (doneAt[task] < Infinity ? doneAt[task] - due : 0)).filter((by) => by > 0);
  if (!late.length) return "-";
  return `${late.length} by ${describeAmount(mission.world, late.reduce((sum, by) => sum + by, 0))}`;
}

function comparedRow(/** @type {App} */ app, /** @type {Trial} */ trial, { columns, judge, missed }) {
  const { history } = trial;
  const title = titleOf(app.trials, trial);
  const over = app.trials.map((other) => other.history).filter((other) => judge(other) !== null);
  const least = Math.min(...over.map(missed));
  const best = Math.min(...over.filter((other) => missed(other) === least).map(judge));
  const value = missed(history) > least ? null : judge(history);
  const isFront = trial === app.trial;
  const name = element("button", { type: "button", class: "link", "data-key": title, title: "Show its details", on: () => app.bringToFront(trial) }, title);
  if (isFront) name.setAttribute("aria-current", "true");
  const cells = [
    `${countDone(history, app.player.step)}/${history.doneAt.length}`,
    ...columns.map(({ of }) => of(history)),
    value === null || best === 0 ? "" : `+${Math.round(100 * (value / best - 1))}%`,
  ];
  return element(
    "tr",
    { class: isFront ? "front" : "" },
    element("th", { scope: "row" }, element("span", { class: "dot", colour: recordColour(app, trial) }), name),
    ...cells.map((text) => element("td", {}, text)),
  );
}

function failedRow({ method, seed, why }, columns) {
  return element("tr", {}, element("td", { colspan: columns, class: "why" }, `${method}, seed ${seed} failed: ${why}`));
}
