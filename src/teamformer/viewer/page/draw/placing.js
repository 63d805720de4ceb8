// Where everything is drawn after a step: robots packed around the middles of their cells.

import { placeLost, robotsLostAt } from "../record/history.js";
import { cellKey } from "../record/mission.js";
import { NOBODY } from "../record/state.js";
import { TEAM_MARGIN, packTeams, robotSites } from "./packing.js";

const ROBOT_RADIUS = 0.33; // of a robot alone in its cell, in cells
export const TASK_HALF = 0.44; // half a task's side, in cells

// By robot {x, y, r}, by cell the radius of all that is in it; in
// cells, with y downwards on the screen turned by the camera. `cell` is a cell's side in pixels.
export function placeEverybody(/** @type {TrialHistory} */ history, /** @type {Scene} */ scene, cell) {
  const { robots } = history.mission;
  const places = {
    x: new Float64Array(robots.length),
    y: new Float64Array(robots.length),
    r: new Float64Array(robots.length),
    cells: new Map(),
  };
  for (const groups of groupsByCell(history, scene).values()) placeCell(places, groups, cell);
  return places;
}

// Robots lost in a cell lie there like a team of their own, with no slot.
function groupsByCell(/** @type {TrialHistory} */ history, /** @type {Scene} */ scene) {
  const placeIn = (robot) => placeLost(history, robot, scene.step);
  const lost = Map.groupBy(robotsLostAt(history, scene.step), (robot) => cellKey(...placeIn(robot)));
  const lying = [...lost.values()].map((robots) => ({ slot: NOBODY, robots, x: placeIn(robots[0])[0], y: placeIn(robots[0])[1] }));
  return Map.groupBy([...scene.teams.values(), ...lying], ({ x, y }) => cellKey(x, y));
}

function placeCell(/** @type {Places} */ places, groups, cell) {
  groups.sort((one, other) => other.robots.length - one.robots.length || one.slot - other.slot);
  const layout = packTeams(groups.map(({ robots }) => robots.length).join(","));
  const count = groups.reduce((sum, { robots }) => sum + robots.length, 0);
  const scale = robotRadius(layout.radius - TEAM_MARGIN, count, cell);
  groups.forEach((group, index) => {
    const circle = layout.circles[index];
    const middle = { x: group.x + circle.x * scale, y: group.y + circle.y * scale };
    placeRobots(places, group.robots, middle, scale);
  });
  places.cells.set(cellKey(groups[0].x, groups[0].y), layout.radius * scale);
}

// Small enough to stay near the cell, large enough to be seen.
function robotRadius(layoutRadius, count, cell) {
  const room = Math.min(1.1, 0.5 + 0.05 * Math.log2(count));
  const visible = (1.1 + 2.9 / count ** 0.25) / cell;
  return Math.max(Math.min(ROBOT_RADIUS, room / layoutRadius), visible);
}

function placeRobots(/** @type {Places} */ places, robots, middle, scale) {
  const sites = robotSites(robots.length);
  robots.forEach((robot, index) => {
    places.x[robot] = middle.x + sites[index].x * scale;
    places.y[robot] = middle.y + sites[index].y * scale;
    places.r[robot] = scale;
  });
}

// Where a task's square is, in cells from the middle of its own: {right, down, half}. It opens to
// embrace the robots that stand there; tasks that share a cell share it out, and line up below
// the robots that come. `least` is half a side in pixels.
export function taskSquare(/** @type {Places} */ places, /** @type {Site} */ { at, mates }, task, cell, least) {
  const inside = places.cells.get(cellKey(...at)) ?? 0;
  if (mates.length === 1) {
    return { right: 0, down: 0, half: Math.max(TASK_HALF, least / cell, inside + 2 / cell) };
  }
  const columns = Math.ceil(Math.sqrt(mates.length));
  const pitch = Math.max((2 * TASK_HALF) / columns, 10 / cell);
  const half = pitch * 0.46;
  const index = mates.indexOf(task);
  const [column, row] = [index % columns, Math.floor(index / columns)];
  const middle = (columns - 1) / 2;
  const rows = Math.ceil(mates.length / columns);
  const down = inside ? inside + 2 / cell + pitch / 2 : (-pitch * (rows - 1)) / 2;
  return { right: (column - middle) * pitch, down: down + row * pitch, half };
}

export function between(from, to, part) {
  return from + (to - from) * part;
}

// The places at a moment between two steps.
export function blendPlaces(from, to, part) {
  if (part === 0 || from === to) return from;
  const blend = (key) => from[key].map((value, robot) => between(value, to[key][robot], part));
  return { ...from, x: blend("x"), y: blend("y"), r: blend("r") };
}
