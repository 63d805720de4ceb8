// What changes over time: tasks done and open, idle robots and the way made, after each step.

import { NOBODY, placeOf } from "./state.js";
import { CARRYING, IDLE, WALKING, runsOf } from "./told.js";

// {open, idle, way}, each with a number for every step from 0 on; `way` is the sum over all robots so
// far, in cells, or squares of a plane. Worked out once for each length of the record.
export function curvesOf(/** @type {TrialHistory} */ history) {
  const known = history.curves;
  if (known?.made === history.last) return known;
  const way = [0];
  const made = history.mission.world.roads ? timeOnTheWay : wayIn;
  for (let step = 1; step <= history.last; step++) way.push(way[step - 1] + made(history, step));
  const idle = idleAfterSteps(history);
  history.curves = { made: history.last, open: openAfterSteps(history), idle, way };
  return history.curves;
}

// Tasks that are known and not over, after each step.
function openAfterSteps(/** @type {TrialHistory} */ { mission, overAt, last }) {
  const everOpen = mission.tasks.flatMap(({ appears }, task) => (appears < overAt[task] ? [task] : []));
  const known = countsUpTo(everOpen.map((task) => mission.tasks[task].appears), last);
  const over = countsUpTo(everOpen.map((task) => overAt[task]), last);
  return known.map((count, step) => count - over[step]);
}

// Tasks that are done, after each step.
export function doneAfterSteps(/** @type {TrialHistory} */ { doneAt, last }) {
  return countsUpTo(doneAt, last);
}

// For each step up to `last`, how many of some steps are not after it.
function countsUpTo(steps, last) {
  const counts = new Array(last + 1).fill(0);
  for (const step of steps) if (step <= last) counts[Math.ceil(step)]++;
  let sum = 0;
  return counts.map((count) => (sum += count));
}

// The way that all robots make in a step. They go by shortest ways, so where none turns back around
// the end of a wall, which takes four cells in one step, it is what lies between the two places.
function wayIn(/** @type {TrialHistory} */ history, step) {
  const { world } = history.mission;
  const [before, after] = [history.at(step - 1), history.at(step)];
  let sum = 0;
  for (let robot = 0; robot < after.team.length; robot++) {
    if (after.team[robot] === NOBODY || before.team[robot] === NOBODY) continue;
    const [was, is] = [placeOf(before, robot), placeOf(after, robot)];
    const [right, up] = [is.x - was.x, is.y - was.y];
    sum += world.isPlane ? Math.hypot(right, up) : Math.abs(right) + Math.abs(up);
  }
  return sum;
}

// On roads, whose ways have no lengths: how long robots were on the way in a tick.
function timeOnTheWay(/** @type {TrialHistory} */ history, step) {
  let sum = 0;
  for (const robot of history.mission.robots.keys()) {
    for (const { phase, from, to } of runsOf(history, robot)) {
      if (phase === WALKING || phase === CARRYING) sum += Math.max(0, Math.min(to, step) - Math.max(from, step - 1));
    }
  }
  return sum;
}

// How many robots were idle in each step.
function idleAfterSteps(/** @type {TrialHistory} */ history) {
  const changes = new Array(history.last + 2).fill(0);
  for (const robot of history.mission.robots.keys()) {
    for (const { phase, from, to } of runsOf(history, robot)) {
      if (phase !== IDLE) continue;
      changes[Math.floor(from) + 1]++;
      changes[Math.floor(to) + 1]--;
    }
  }
  let sum = 0;
  return changes.slice(0, -1).map((change) => (sum += change));
}
