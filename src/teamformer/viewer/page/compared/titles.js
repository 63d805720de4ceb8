// What tells a record from the others that are shown.

import { GOLDEN_ANGLE, oklch } from "../draw/palette.js";
import { element } from "../panel/dom.js";
import { describeProgress } from "../panel/header.js";

// What tells a record from the others: its method; its mission or seed where these differ.
export function titleOf(/** @type {Trial[]} */ trials, /** @type {Trial} */ { history }) {
  const differs = (read) => new Set(trials.map((trial) => read(trial.history))).size > 1;
  const { mission, record } = history;
  const parts = [differs((other) => other.mission.name) ? mission.name : "", record.method, differs((other) => other.record.seed) ? `seed ${record.seed}` : ""];
  return parts.filter(Boolean).join(", ");
}

// The colour of a record in curves, tables and captions: by its place among those opened.
export function recordColour(/** @type {App} */ { trials, map }, /** @type {Trial} */ trial) {
  return oklch(map.isDark ? 0.76 : 0.54, 0.15, 262 + trials.indexOf(trial) * GOLDEN_ANGLE);
}

// A record's title, over its Gantt chart and on its map, with how far it is.
export function recordItem(shown) {
  const { history, player, trial } = shown;
  const app = shown.app ?? shown;
  const progress = describeProgress(history, player.step);
  const dot = element("span", { class: "dot", colour: recordColour(app, trial) });
  return element("li", { class: "of" }, dot, element("strong", {}, titleOf(app.trials, trial)), ` ${progress}`);
}
