// Robots, tasks and capabilities as small labels that lead to their details.

import { describeCounts, nameOfTeam, taskName } from "../record/words.js";
import { element, foldedList, link, swatch, taskMark } from "./dom.js";

export const CHIPS_SHOWN = 12;
const SWATCHES_SHOWN = 4;

function chip(key, on, title, ...children) {
  return element("button", { type: "button", class: "chip", "data-key": key, on, title }, ...children);
}

export function robotChips(/** @type {App} */ app, robots, chosen = -1) {
  const chips = robots.map((robot) => robotChip(app, robot, robot === chosen));
  return foldedList("robots", "chips", chips, CHIPS_SHOWN);
}

function robotChip(/** @type {App} */ app, robot, isChosen) {
  const { name, can } = app.history.mission.robots[robot];
  const title = `${name}: ${describeCounts(app.history.mission, can)}`;
  const text = isChosen ? element("b", {}, name) : name;
  return chip(`robot ${robot}`, () => app.select({ robot }), title, ...swatches(app, can), text);
}

// A disc for each of the first capabilities of a robot.
export function swatches(/** @type {App} */ app, can) {
  return can.slice(0, SWATCHES_SHOWN).map(([cap]) => swatch(app, cap));
}

export function taskChip(/** @type {App} */ app, task) {
  const name = taskName(app.history.mission, task);
  return chip(`task ${task}`, () => app.select({ task }), name, taskMark(app, task), name);
}

// Those that are short come first and are marked.
export function capabilityChips(/** @type {App} */ app, key, /** @type {Iterable<Count>} */ counts, /** @type {Counts} */ short = []) {
  const lacking = new Map(short);
  /** @type {(one: Count, other: Count) => number} */
  const order = ([one], [other]) => Number(lacking.has(other)) - Number(lacking.has(one)) || one - other;
  const chips = [...counts].sort(order).map(([cap, count]) => {
    const text = describeCounts(app.history.mission, [[cap, count]]);
    const title = lacking.has(cap) ? `${text}: nobody assigned brings it` : text;
    const node = chip(`${key} ${cap}`, () => app.select({ cap }), title, swatch(app, cap), text);
    node.classList.toggle("short", lacking.has(cap));
    return node;
  });
  return foldedList(key, "chips", chips, CHIPS_SHOWN);
}

export function teamLink(/** @type {App} */ app, /** @type {Team} */ team) {
  const go = () => app.select({ robot: team.slot });
  return link(nameOfTeam(app.history.mission, team), go, `team ${team.slot}`);
}

export function taskLink(/** @type {App} */ app, task) {
  const go = () => app.select({ task });
  return element("p", {}, link(taskName(app.history.mission, task), go, `task ${task}`));
}
