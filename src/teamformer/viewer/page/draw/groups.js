// Robots too small to tell apart: groups with their number, or how dense they lie.

import { ACTIVITIES } from "../panel/inspector.js";
import { plural } from "../record/lengths.js";
import { cellKey } from "../record/mission.js";
import { NOBODY, placeOf } from "../record/state.js";
import { between } from "./placing.js";
import { drawDisc, isOnScreen, lazily, strokeAs, write } from "./shapes.js";
import { drawLostRobots, drawTeam } from "./teams.js";

const GROUPS_FROM = 40; // robots; fewer are always drawn one by one
const DENSITY_FROM = 300;
const ROBOTS_ABOVE = 13; // pixels a cell that leave room for each robot
const DENSITY_BELOW = 9;
const GROUP_SIDE = 44; // pixels
export const DENSE_SIDE = 9;
const LONE_ROBOTS = 2; // in a group's square, drawn as robots

// How much of each robot is drawn at a zoom: "robots", "groups" or "density".
export function detailAt(/** @type {Mission} */ mission, cell) {
  const count = mission.robots.length;
  if (count < GROUPS_FROM || cell >= ROBOTS_ABOVE) return "robots";
  return count >= DENSITY_FROM && cell < DENSITY_BELOW ? "density" : "groups";
}

// Squares of the screen that hold teams: [{x, y, teams, count}], fixed to the map when it is moved.
function gatherGroups(/** @type {View} */ view, side) {
  const { camera, scene, part } = view;
  const next = part > 0 ? view.sceneAfter : scene;
  const squares = new Map();
  for (const team of scene.teams.values()) {
    const then = placeOf(next.state, team.slot);
    const isThere = next.state.team[team.slot] !== NOBODY;
    const x = camera.x(isThere ? between(team.x, then.x, part) : team.x);
    const y = camera.y(isThere ? between(team.y, then.y, part) : team.y);
    if (!isOnScreen(view, x, y, side)) continue;
    const [column, row] = [(x - camera.left) / side, (y - camera.top) / side].map(Math.floor);
    const key = cellKey(column, row);
    const group = squares.get(key) ?? { x: 0, y: 0, teams: [], count: 0, column, row };
    const size = team.robots.length;
    group.x += x * size;
    group.y += y * size;
    group.count += size;
    group.teams.push(team);
    squares.set(key, group);
  }
  for (const group of squares.values()) {
    group.x /= group.count;
    group.y /= group.count;
    group.r = Math.min(GROUP_SIDE / 2, 8 + 2.4 * Math.sqrt(group.count));
  }
  return [...squares.values()];
}

function drawGroups(/** @type {View} */ view) {
  view.groups = gatherGroups(view, GROUP_SIDE).filter(({ count, teams }) => {
    if (count > LONE_ROBOTS) return true;
    for (const team of teams) drawTeam(view, team);
    return false;
  });
  for (const group of view.groups) drawGroup(view, group);
  drawLostRobots(view);
}

// A disc with the number of robots; its ring says what their teams do.
function drawGroup(/** @type {View} */ { ctx, theme }, /** @type {Group} */ { x, y, r, count, teams }) {
  drawDisc(ctx, x, y, r, theme.surface);
  let start = -Math.PI / 2;
  for (const [activity, robots] of countActivities(teams)) {
    const end = start + (2 * Math.PI * robots) / count;
    ctx.beginPath();
    ctx.arc(x, y, r - 2, start, end);
    strokeAs(ctx, theme[ACTIVITY_COLOURS[activity]], 4);
    start = end;
  }
  write(ctx, String(count), x, y + 0.5, theme.ink, `600 ${Math.min(13, r * 0.9)}px ${theme.font}`);
}

export const ACTIVITY_COLOURS = {
  walks: "accent",
  waits: "wait",
  serves: "good",
  done: "good",
  idle: "lost",
  off: "lost",
  told: "lost",
  leaves: "lost",
};

function countActivities(teams) {
  const counts = new Map(Object.keys(ACTIVITY_COLOURS).map((activity) => [activity, 0]));
  for (const { activity, robots } of teams) counts.set(activity, counts.get(activity) + robots.length);
  return counts;
}

// The more robots in a small square, the stronger its colour.
function drawDensity(/** @type {View} */ view) {
  const { ctx, camera, theme } = view;
  const squares = gatherGroups(view, DENSE_SIDE);
  const most = squares.reduce((found, { count }) => Math.max(found, count), 1);
  ctx.fillStyle = theme.accent;
  view.mostInSquare = most;
  for (const { column, row, count } of squares) {
    ctx.globalAlpha = densityStrength(count, most);
    ctx.fillRect(camera.left + column * DENSE_SIDE, camera.top + row * DENSE_SIDE, DENSE_SIDE - 1, DENSE_SIDE - 1);
  }
  ctx.globalAlpha = 1;
  lazily(view, "groups", () => gatherGroups(view, GROUP_SIDE));
}

// How strong the colour of a square with so many robots is, of which others have at most `most`.
export function densityStrength(count, most) {
  return 0.25 + (0.75 * Math.log(1 + count)) / Math.log(1 + most);
}

// The group under a pixel: one click comes nearer to it.
export function groupUnder(/** @type {View} */ view, x, y) {
  const reach = ({ r }) => (view.detail === "density" ? GROUP_SIDE / 2 : r);
  const found = (view.groups ?? []).find((group) => Math.hypot(group.x - x, group.y - y) <= reach(group));
  return found ? { group: found } : null;
}

export function describeGroup(/** @type {Group} */ { count, teams }) {
  const parts = [...countActivities(teams)].filter(([, robots]) => robots).map(([activity, robots]) => `${robots} ${ACTIVITIES[activity]}`);
  return [plural(count, "robot"), parts.join(", ")];
}

export function drawTeams(/** @type {View} */ view) {
  if (view.detail === "groups") return drawGroups(view);
  if (view.detail === "density") return drawDensity(view);
  for (const team of view.scene.teams.values()) drawTeam(view, team);
  drawLostRobots(view);
}
