// What stands still around the map: the header, the legend, the notice of a trial that failed.

import { costOf } from "../record/costs.js";
import { robotsLostAt } from "../record/history.js";
import { capitalised, describeAmount, plural } from "../record/lengths.js";
import { countCancelled, countDone } from "../record/scene.js";
import { describeAt, listRobots } from "../record/words.js";
import { byId, element, swatch } from "./dom.js";
import { notify } from "./notice.js";

const LEGEND_SHOWN = 10;

export function showHeader(/** @type {App} */ app) {
  const { history } = app;
  const { mission, record } = history;
  byId("name").textContent = mission.name;
  byId("about").textContent = [
    ...(record.method ? [`Method ${record.method}`, `seed ${record.seed}`] : ["Draft"]),
    plural(mission.robots.length, "robot"),
    plural(mission.tasks.length, "task"),
    mission.capabilities.length === 1 ? "1 capability" : `${mission.capabilities.length} capabilities`,
  ].join(", ");
  notify(noticeText(history));
  byId("legend").replaceChildren(...legend(app));
}

export function noticeText(/** @type {TrialHistory} */ { end }) {
  if (end.status !== "infeasible") return "";
  const names = end.blocked_tasks;
  const shown = names.slice(0, 8).join(", ") + (names.length > 8 ? ` and ${names.length - 8} more` : "");
  return `Can never be done: ${shown}. The robots that are left do not bring all that is needed.`;
}

function legend(/** @type {App} */ app) {
  const { capabilities } = app.history.mission;
  if (capabilities.length > LEGEND_SHOWN) {
    const open = () => {
      app.lists.open("capabilities");
      byId("filter").focus();
    };
    return [element("li", {}, element("button", { type: "button", class: "all", on: open }, `${capabilities.length} capabilities`))];
  }
  return capabilities.map((name, cap) => {
    const on = () => app.select({ cap });
    const title = "Show who brings it and what needs it";
    return element("li", {}, element("button", { type: "button", on, title }, swatch(app, cap), name));
  });
}

export function showFigures(/** @type {App} */ app) {
  const { history, player } = app;
  const done = countDone(history, player.step);
  const { makespan } = history.end;
  const bound = history.lowerBound;
  const { world } = history.mission;
  byId("figures").replaceChildren(
    figure("Tasks done", String(done), ` of ${history.doneAt.length}${cancelledText(history, player.step)}`),
    figure("Makespan", makespan === null ? noMakespan(history) : describeAmount(world, makespan), ratioText(history)),
    ...costFigure(history),
    figure("Lower bound", bound === null ? "unknown" : describeAmount(world, bound), ""),
    ...lostFigure(history, player.step),
    ...brokenLinks(history),
  );
  const status = app.statusText() || statusAt(history, player.step);
  byId("status").textContent = capitalised(status);
  byId("status").className = `status ${status.replaceAll(" ", "-")}`;
}

// How many tasks were called off, after how many are done of all.
function cancelledText(/** @type {TrialHistory} */ history, step) {
  const cancelled = countCancelled(history, step);
  return cancelled ? `, ${cancelled} called off` : "";
}

// What the mission cost, by its own weights.
function costFigure(/** @type {TrialHistory} */ history) {
  if (!history.mission.cost) return [];
  const cost = costOf(history);
  return [figure("Cost", cost === null ? noMakespan(history) : String(Number(cost.toPrecision(6))), "")];
}

function noMakespan(/** @type {TrialHistory} */ { end }) {
  return end.status === "running" ? "not yet" : "none";
}

// How the trial ended is said once its end is shown.
function statusAt(/** @type {TrialHistory} */ history, step) {
  if (step >= history.last) return history.end.status;
  return step === 0 ? "at the start" : "under way";
}

function lostFigure(/** @type {TrialHistory} */ history, step) {
  const lost = robotsLostAt(history, step);
  return lost.length ? [figure("Lost", listRobots(history.mission, lost), "")] : [];
}

// Tasks that did not start at their distance from another's start, in continuous time.
function brokenLinks(/** @type {TrialHistory} */ { end }) {
  const pairs = end.broken_links ?? [];
  if (!pairs.length) return [];
  return [figure("Broken links", String(pairs.length), ` ${pairs.slice(0, 3).map(([task, other]) => `${task} to ${other}`).join(", ")}`)];
}

// Where a record stands, in a line.
export function describeProgress(/** @type {TrialHistory} */ history, step) {
  const { mission, end, doneAt } = history;
  const done = `${countDone(history, step)} of ${doneAt.length} tasks${cancelledText(history, step)}`;
  if (step < history.last) return done;
  const makespan = end.makespan === null ? "" : ` ${describeAt(mission.world, end.makespan)}`;
  return `${done}, ${end.status}${makespan}`;
}

function ratioText(/** @type {TrialHistory} */ { end, lowerBound, mission }) {
  if (end.makespan === null) return "";
  const seconds = mission.world.isTimed && mission.world.secondsUnit ? plural(end.makespan, "step") : "";
  const ratio = lowerBound ? `${(end.makespan / lowerBound).toFixed(2)} x the bound` : "";
  const notes = [seconds, ratio].filter(Boolean);
  return notes.length ? ` ${notes.join(", ")}` : "";
}

function figure(title, value, note) {
  return element(
    "div",
    { class: title.toLowerCase().replaceAll(" ", "-") },
    element("dt", {}, title),
    element("dd", { title: value }, value, element("small", {}, note)),
  );
}
