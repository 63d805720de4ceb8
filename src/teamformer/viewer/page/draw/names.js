// Names under tasks and over places with teams; one that would cover another is left out.

import { robotsLostAt } from "../record/history.js";
import { cellKey } from "../record/mission.js";
import { isOver, standingOf } from "../record/scene.js";
import { MANY, robotName, taskName } from "../record/words.js";
import { ringColour } from "./palette.js";
import { fillAs, isOnScreen, robotSpot, strokeAs, teamSpot, write } from "./shapes.js";
import { taskBox } from "./tasks.js";

const NAMES_FROM = 20; // pixels a cell
const PLACES_NAMED_FROM = 14;
const TEAMS_NAMED = 3; // in one place
const BADGE_FROM = 12; // robots
const LONGEST_NAME = 40; // letters
const WIDEST = 6; // cells, of the names of several tasks in one place
const PROGRESS = 5; // pixels around a task in which what is made of it may be drawn
const LOST_NAMED = 12; // robots, whatever the zoom

export function drawNames(/** @type {View} */ view) {
  const { ctx, theme, camera, options, mission } = view;
  const taken = [];
  view.names = taken;
  ctx.font = `500 11px ${theme.font}`;
  ctx.textAlign = "center";
  ctx.textBaseline = "middle";
  nameTasksAndRobots(view, taken, options.names && camera.cell >= NAMES_FROM);
  if (mission.world.roads && options.names && camera.cell >= PLACES_NAMED_FROM) namePlaces(view, taken, mission.world.roads);
}

// The places of roads, over or under them, where their names cover no task and no other name.
function namePlaces(/** @type {View} */ view, taken, /** @type {Roads} */ { names, places }) {
  const { camera, theme } = view;
  const above = Math.max(12, 0.8 * camera.cell);
  places.forEach(([right, up], place) => {
    const [x, middle] = [camera.x(right), camera.y(up)];
    const half = view.ctx.measureText(names[place]).width / 2;
    const y = [middle - above, middle + above].find((at) => !isOverTask(view, { x, y: at, half }));
    if (y !== undefined) drawName(view, taken, names[place], { x, y }, theme.muted);
  });
}

// Whether a text in the middle of a line, so far to both sides, covers a task.
export function isOverTask(/** @type {View} */ view, { x, y, half }) {
  return view.mission.tasks.some((_, task) => {
    if (standingOf(view.history, task, view.scene.step) === "hidden") return false;
    const box = taskBox(view, task);
    return Math.abs(box.x - x) < box.half + half && Math.abs(box.y - y) < box.half + 6;
  });
}

function nameTasksAndRobots(/** @type {View} */ view, taken, isRoomy) {
  view.mission.tasks.forEach((_, task) => {
    if (isRoomy || task === view.selection.task) drawTaskName(view, taken, task);
  });
  const lost = robotsLostAt(view.history, view.scene.step);
  const discs = view.detail === "robots" ? discsByCell(view) : new Map();
  if (isRoomy || lost.length <= LOST_NAMED) drawLostNames(view, taken, lost, discs);
  if (view.detail !== "robots") return;
  for (const teams of Map.groupBy(view.scene.teams.values(), ({ x, y }) => cellKey(x, y)).values()) {
    const named = isRoomy ? teams : teams.filter((team) => team === view.selectedTeam);
    if (named.length) drawTeamNames(view, taken, named, discs);
    if (!isRoomy) drawBadges(view, teams);
  }
}

function drawTaskName(/** @type {View} */ view, taken, task) {
  const { theme, sites, history, scene } = view;
  const standing = standingOf(history, task, scene.step);
  if (standing === "hidden") return;
  const { at, mates, isUp } = sites[task];
  const box = taskBox(view, mates.at(-1));
  const [x, y, half] = [isUp ? box.x : view.camera.x(at[0]), box.y, box.half];
  const colour = isOver(history, task, scene.step) ? theme.faint : theme.muted;
  const below = y + half + 10 + (standing === "served" ? PROGRESS : 0);
  drawName(view, taken, namesOfPlace(view, mates), { x, y: below }, colour);
}

// One line for all tasks in one place: as many names as there is room for, one at least.
function namesOfPlace(/** @type {View} */ { ctx, mission, camera }, /** @type {number[]} */ mates) {
  const line = (count) => {
    const shown = mates.slice(0, count).map((mate) => taskName(mission, mate));
    return shown.join(", ") + (mates.length > count ? ` + ${mates.length - count} more` : "");
  };
  let count = Math.min(MANY, mates.length);
  const isTooLong = (text) => text.length > LONGEST_NAME || ctx.measureText(text).width > WIDEST * camera.cell;
  while (count > 1 && isTooLong(line(count))) count--;
  return line(count);
}

function drawLostNames(/** @type {View} */ view, taken, lost, discs) {
  const { mission, theme } = view;
  for (const robot of lost) {
    const { x, y, r } = robotSpot(view, robot);
    const name = `${robotName(mission, robot)}, lost`;
    const half = view.ctx.measureText(name).width / 2;
    const isFree = (at) => !isOverDisc(view, discs, new Set([robot]), { x, y: at, half });
    const at = [y - r - 9, y + r + 9].find(isFree) ?? y - r - 9;
    drawName(view, taken, name, { x, y: at }, theme.bad);
  }
}

// One line over all that is in a place, or over the task that is there; under it where other robots
// are over it.
function drawTeamNames(/** @type {View} */ view, taken, teams, discs) {
  const { mission, theme, camera } = view;
  if (!isOnScreen(view, camera.x(teams[0].x), camera.y(teams[0].y), 2 * camera.cell)) return;
  const texts = teams.slice(0, TEAMS_NAMED).map(({ slot, robots }) => {
    const more = robots.length > 1 ? ` +${robots.length - 1}` : "";
    return robotName(mission, slot) + more;
  });
  if (teams.length > TEAMS_NAMED) texts.push(`${teams.length - TEAMS_NAMED} more`);
  const spots = teams.map((team) => teamSpot(view, team));
  const x = spots.reduce((sum, spot) => sum + spot.x, 0) / spots.length;
  const top = Math.min(...spots.map((spot) => spot.y - spot.r));
  const middle = spots.reduce((sum, spot) => sum + spot.y, 0) / spots.length;
  const y = Math.min(top, topOfTaskAround(view, x, middle)) - 10;
  const own = new Set(teams.flatMap(({ robots }) => robots));
  const half = view.ctx.measureText(texts.join(", ")).width / 2;
  const isFree = (at) => !isOverDisc(view, discs, own, { x, y: at, half });
  const below = Math.max(...spots.map((spot) => spot.y + spot.r)) + 10;
  const at = [y, below].find(isFree);
  if (at !== undefined) drawName(view, taken, texts.join(", "), { x, y: at }, theme.ink);
}

// The robots on the map by the cell that they are drawn in.
/** @returns {Map<string, number[]>} */
function discsByCell(/** @type {View} */ { blended, mission }) {
  return Map.groupBy(mission.robots.keys(), (robot) => cellKey(Math.round(blended.x[robot]), Math.round(blended.y[robot])));
}

// Whether a line of text would lie over a robot that is not one of its own.
function isOverDisc(/** @type {View} */ view, discs, own, { x, y, half }) {
  const [[left, one], [right, other]] = [[x - half, y - 6], [x + half, y + 6]].map(([px, py]) => view.camera.placeAt(px, py));
  const [low, high] = [Math.round(Math.min(one, other)), Math.round(Math.max(one, other))];
  for (let column = Math.round(left) - 1; column <= Math.round(right) + 1; column++) {
    for (let row = low - 1; row <= high + 1; row++) {
      for (const robot of discs.get(cellKey(column, row)) ?? []) {
        if (own.has(robot)) continue;
        const spot = robotSpot(view, robot);
        if (Math.abs(spot.x - x) < spot.r + half && Math.abs(spot.y - y) < spot.r + 5) return true;
      }
    }
  }
  return false;
}

// The upper edge of the task whose square a pixel is in, if it is in one; teams walk through such squares too.
function topOfTaskAround(/** @type {View} */ view, x, y) {
  const [column, row] = view.camera.placeAt(x, y).map(Math.round);
  const [task] = view.mission.tasksAt.get(cellKey(column, row)) ?? [];
  if (task === undefined || standingOf(view.history, task, view.scene.step) === "hidden") return Infinity;
  const box = taskBox(view, task);
  return Math.max(Math.abs(box.x - x), Math.abs(box.y - y)) <= box.half ? box.y - box.half - PROGRESS : Infinity;
}

function drawBadges(/** @type {View} */ view, teams) {
  for (const team of teams) if (team.robots.length >= BADGE_FROM) drawBadge(view, team);
}

// The number of robots of a large team, at its upper right.
function drawBadge(/** @type {View} */ view, /** @type {Team} */ team) {
  const { ctx, theme } = view;
  const spot = teamSpot(view, team);
  const [x, y] = [spot.x + spot.r * 0.72, spot.y - spot.r * 0.72];
  const text = String(team.robots.length);
  const half = ctx.measureText(text).width / 2 + 5;
  ctx.beginPath();
  ctx.roundRect(x - half, y - 8, 2 * half, 16, 8);
  fillAs(ctx, theme.surface);
  strokeAs(ctx, ringColour(team, view.isDark, view.options.rings), 2);
  ctx.fillStyle = theme.ink;
  ctx.fillText(text, x, y + 0.5);
}

function drawName(/** @type {View} */ view, taken, name, { x: middle, y }, colour) {
  const { ctx, theme } = view;
  if (!isOnScreen(view, middle, y, 60)) return;
  const text = name.length > LONGEST_NAME ? `${name.slice(0, LONGEST_NAME - 1)}…` : name;
  const half = ctx.measureText(text).width / 2 + 2;
  const x = Math.max(half, Math.min(middle, view.width - half)); // not cut off at a side
  const covers = (box) => Math.abs(box.x - x) < box.half + half && Math.abs(box.y - y) < 13;
  if (taken.some(covers)) return;
  taken.push({ text, x, y, half });
  write(ctx, text, x, y, colour, ctx.font, "center", "middle", theme.ground);
}
