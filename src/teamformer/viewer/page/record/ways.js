// The ways that teams take: straight on planes, around obstacles as the simulator walks on grids.

import { SIDES, isFreeCell, walkingDistance } from "./mission.js";
import { isSamePlace } from "./plane.js";

// The places on the way from a place to a goal where the direction changes, both ends included.
export function wayTo(/** @type {World} */ world, /** @type {Place} */ from, /** @type {Place} */ goal, flies) {
  if (world.isPlane || isSamePlace(world, from, goal)) return [from, goal];
  const corners = [from];
  let [place, heading] = [from, ""];
  while (!isSamePlace(world, place, goal)) {
    const next = nextOnWay(world, place, goal, flies);
    if (!next) return [from, goal]; // no way leads there
    const along = next[0] !== place[0] ? "x" : "y";
    if (heading && along !== heading) corners.push(place);
    heading = along;
    place = next;
  }
  return [...corners, goal];
}

// One cell nearer; of several, the one on the axis with more left to go, as teams walk.
function nextOnWay(/** @type {World} */ world, /** @type {Place} */ [x, y], /** @type {Place} */ goal, flies) {
  const isAlongX = Math.abs(goal[0] - x) >= Math.abs(goal[1] - y);
  const nearer = walkingDistance(world, [x, y], goal, flies) - 1;
  const steps = SIDES.map(([right, up]) => /** @type {Place} */ ([x + right, y + up])).filter(
    (cell) => (flies || isFreeCell(world, ...cell)) && walkingDistance(world, cell, goal, flies) === nearer,
  );
  return steps.find((cell) => (cell[0] !== x) === isAlongX) ?? steps[0];
}
