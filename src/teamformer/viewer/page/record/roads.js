// Roads as the page draws them: the record says where their places lie, in squares, and where a road is.

import { zonesPlaced } from "./plane.js";

// The mission and its truth with places for names, and what a map of roads needs.
export function laidOut(/** @type {MissionTree} */ mission, truth, told) {
  const map = layoutOf(told?.map) ?? inACircle(namesIn(mission.world.roads));
  const { names } = map;
  const numbers = new Map(names.map((name, number) => [name, number]));
  const at = (name) => (name === undefined || name === null ? name : map.places[numbers.get(name) ?? name[0]]);
  const placed = (thing) => ({ ...thing, at: at(thing.at), ...(thing.to ? { to: at(thing.to) } : {}) });
  const real = truth && { ...truth, arrivals: truth.arrivals?.map(placed) };
  const [robots, tasks, chargers] = [mission.robots, mission.tasks, mission.chargers].map((things) => things?.map(placed));
  const shown = { ...mission, robots, tasks, chargers, zones: zonesPlaced(mission.zones, at) };
  return { mission: shown, truth: real, map };
}

// The map that a record brings, if it is whole.
function layoutOf(map) {
  const isWhole = ["names", "size", "places", "roads"].every((key) => Array.isArray(map?.[key]));
  return isWhole && map.names.length === map.places.length ? map : null;
}

// The places of roads as the table of a mission names them, in its first row.
function namesIn(roads) {
  const table = typeof roads === "string" ? roads : Object.values(roads)[0];
  return table.split("\n")[0].split(",").slice(1);
}

// Where a record brings no map, places lie in a circle.
function inACircle(names) {
  const radius = Math.max(3, names.length / 2);
  const turn = (number) => (2 * Math.PI * number) / names.length;
  const places = names.map((_, n) => [radius + 1 + radius * Math.cos(turn(n)), radius + 1 + radius * Math.sin(turn(n))]);
  return { names, size: [2 * radius + 2, 2 * radius + 2], places, roads: [] };
}

/** @returns {World} */
export function worldOfRoads({ names, size: [width, height], places, roads }) {
  const used = { left: 0, low: 0, width, height };
  const straight = { rows: [], isBlocked: () => false, used, yIsUp: true, fields: new Map(), isPlane: true, square: 1, arrival: 0 };
  return { width, height, ...straight, stepSeconds: 1, isTimed: true, secondsUnit: "", roads: { names, places, pairs: roads } };
}

// The name of a place of roads; between two of them there is none.
export function nameOfPlace(/** @type {World} */ { roads }, [x, y]) {
  const number = roads?.places.findIndex((place) => Math.hypot(place[0] - x, place[1] - y) < 1e-6) ?? -1;
  return number < 0 ? "" : roads?.names[number];
}
