// Lengths and times in words: metres and seconds on planes, cells and steps on grids; in continuous time
// the mission's unit, which has no name, and of roads the names of places.

import { nameOfPlace } from "./roads.js";

export function describeWay(/** @type {World} */ world, length) {
  if (world.isTimed && !world.isPlane) return plural(Number(length.toFixed(2)), "cell");
  return world.isPlane ? `${(length * world.square).toFixed(2)} m` : plural(length, "cell");
}

export function describePlace(/** @type {World} */ world, at) {
  if (world.roads) return nameOfPlace(world, at) || "a place between two others";
  const [x, y] = world.isPlane ? at.map((along) => (along * world.square).toFixed(2)) : at;
  return `[${x}, ${y}]${world.isPlane ? " m" : ""}`;
}

// A moment or a span: seconds on planes; on grids, whose steps have no length, steps; a number of units
// in continuous time.
export function describeMoment(/** @type {World} */ world, step) {
  return world.isTimed ? `${secondsOf(world, step)}${world.secondsUnit}` : `step ${step}`;
}

export function describeSpan(/** @type {World} */ world, steps) {
  return world.isTimed ? `${secondsOf(world, steps)}${world.secondsUnit}` : plural(steps, "step");
}

// The same where a column says what it is.
export function shortMoment(/** @type {World} */ world, step) {
  return world.isTimed ? `${secondsOf(world, step)}${world.secondsUnit}` : String(step);
}

export function secondsOf(/** @type {World} */ world, steps) {
  return Number((steps * world.stepSeconds).toFixed(2));
}

export function plural(count, word) {
  return `${count} ${word}${count === 1 ? "" : "s"}`;
}

export function capitalised(text) {
  return text.charAt(0).toUpperCase() + text.slice(1);
}

export function percent(part) {
  return `${Math.round(100 * part)}%`;
}

export function describeAmount(/** @type {World} */ world, steps) {
  return world.isTimed ? describeSpan(world, steps) : String(steps);
}
