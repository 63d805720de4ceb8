// Who waits for what: what a task still lacks, who brings it and how far they are.

import { addCounts, missing, overlap, sumCounts } from "../record/counts.js";
import { needsAt, sitesAt } from "../record/history.js";
import { describeWay } from "../record/lengths.js";
import { isSamePlace } from "../record/plane.js";
import { robotsWith } from "../record/scene.js";
import { describeAt, describeCounts, distanceTo, listRobots } from "../record/words.js";
import { teamLink } from "./chips.js";
import { element, foldedList, swatch, titled } from "./dom.js";

const WAITS_SHOWN = 5;
const BRINGERS_SHOWN = 3;

// One item for each requirement that is short; `team` is the one that waits, if one does.
export function waitingFor(/** @type {App} */ app, task, /** @type {Counts} */ short, /** @type {Team | null} */ team) {
  if (!short.length) return null;
  const items = short.map((requirement) => waitingItem(app, task, requirement, team));
  const list = foldedList("waiting", "waits", items, WAITS_SHOWN);
  return element("div", {}, ...titled("Waiting for", list));
}

function waitingItem(/** @type {App} */ app, task, /** @type {Count} */ [cap, count], /** @type {Team | null} */ team) {
  const { mission } = app.history;
  const bringers = assignedByDistance(app, task).filter((other) => other !== team && other.counts.has(cap));
  const what = describeCounts(mission, [[cap, count]]);
  const who = bringers.slice(0, BRINGERS_SHOWN).map((other) => [teamLink(app, other), ` brings it and ${farText(mission, other)}`]);
  if (!who.length) who.push([nobodyBrings(app, cap)]);
  return element(
    "li",
    { class: bringers.length ? "" : "short" },
    element("span", { class: "chips" }, swatch(app, cap), what),
    ...who.map((parts) => element("p", {}, ...parts)),
  );
}

function assignedByDistance(/** @type {App} */ app, task) {
  const { mission } = app.history;
  const teams = [...(app.scene().assignedTo.get(task) ?? [])];
  const away = new Map(teams.map((team) => [team, team.ahead?.until ?? distanceTo(mission, team)]));
  return teams.sort((one, other) => Number(away.get(one)) - Number(away.get(other)));
}

function farText(/** @type {Mission} */ mission, /** @type {Team} */ team) {
  if (team.site && isSamePlace(mission.world, [team.x, team.y], team.site.at)) return "is there";
  if (team.ahead) return `is there ${describeAt(mission.world, team.ahead.until)}`;
  const way = describeWay(mission.world, distanceTo(mission, team));
  return team.carries ? `carries it, ${way} to go` : `is ${way} away`;
}

function nobodyBrings(/** @type {App} */ { history, player }, cap) {
  const { mission } = history;
  const left = robotsWith(history, cap, player.step);
  if (!left.length) return `lost with ${listRobots(mission, robotsWith(history, cap, 0))}`;
  return `nobody assigned brings it; ${listRobots(mission, left)} could`;
}

// What is short at the task itself: beyond the team there that lacks least.
export function missingOfBest(/** @type {App} */ app, task) {
  const { at } = sitesAt(app.history, app.player.step)[task];
  const needs = needsNow(app, task);
  const { world } = app.history.mission;
  const here = [...app.scene().teams.values()].filter(({ x, y }) => isSamePlace(world, [x, y], at));
  const shorts = here.map(({ counts }) => missing(counts, needs));
  return shorts.reduce((best, short) => (sumCounts(short) < sumCounts(best) ? short : best), needs);
}

// What all teams assigned to a task together do not bring.
export function lackingAt(/** @type {App} */ app, task) {
  const teams = app.scene().assignedTo.get(task) ?? [];
  const together = addCounts(teams.map(({ counts }) => counts));
  return missing(together, needsNow(app, task));
}

function needsNow(/** @type {App} */ { history, player }, task) {
  return needsAt(history, task, player.step);
}

export function assignedTeams(/** @type {App} */ app, task) {
  const { mission } = app.history;
  const needs = needsNow(app, task);
  const items = assignedByDistance(app, task).map((team) => {
    const brings = describeCounts(mission, overlap(team.counts, needs), WAITS_SHOWN) || "nothing";
    const text = ` ${farText(mission, team)}, brings ${brings}`;
    return element("li", {}, teamLink(app, team), text);
  });
  if (!items.length) return null;
  const list = foldedList("assigned", "waits", items, WAITS_SHOWN);
  return element("div", {}, ...titled("Assigned teams", list));
}
