// What each robot did in each step: the rows of the Gantt view, and the shares of its time.
// @ts-nocheck

import { pursuedIn, sitesAt } from "./history.js";
import { isSamePlace } from "./plane.js";
import { robotsServing } from "./services.js";
import { NOBODY, placeOf } from "./state.js";

// A load is not served: it is loaded where it lies, carried, and unloaded where it goes.
export const PHASES = ["walks", "waits", "forms", "serves", "loads", "carries", "unloads", "idle", "lost"];
export const AT_WORK = ["serving", "loading", "carrying", "unloading"];
export const PHASE_NAMES = {
  walks: "walking",
  waits: "waiting",
  forms: "forming",
  serves: "serving",
  loads: "loading",
  carries: "carrying",
  unloads: "unloading",
  idle: "idle",
  lost: "lost",
};
export const [WALKS, WAITS, FORMS, SERVES, LOADS, CARRIES, UNLOADS, IDLE, LOST] = PHASES.keys();

// By robot, what it did in one step: `phasesIn(history, 1)` is about the first.
export function phasesIn(history, step) {
  return workIn(history, step).phases;
}

// By robot, the task that it was about in one step, or NOBODY.
export function pursuitsIn(history, step) {
  return workIn(history, step).pursuits;
}

function workIn(history, step) {
  history.work ??= [];
  for (let made = history.work.length; made < step; made++) {
    history.work.push(workOut(history, made + 1));
  }
  return history.work[step - 1];
}

function workOut(history, step) {
  const [before, after] = [history.at(step - 1), history.at(step)];
  const forming = robotsForming(before, history.record.steps[step - 1]);
  const work = workOfTeams(history, after, step);
  const pursuits = pursuitsFrom(history, before, after, step);
  const phases = Uint8Array.from(after.team, (slot, robot) => {
    if (slot === NOBODY || before.team[robot] === NOBODY) return LOST;
    if (forming.has(robot)) return FORMS;
    if (work.has(slot)) return work.get(slot);
    const [was, is] = [placeOf(before, robot), placeOf(after, robot)];
    if (was.x !== is.x || was.y !== is.y) return WALKS;
    if (pursuits[robot] === NOBODY) return IDLE;
    const { at } = sitesAt(history, step)[pursuits[robot]];
    return isSamePlace(history.mission.world, [is.x, is.y], at) ? WAITS : WALKS;
  });
  return { phases, pursuits };
}

// What a robot's team heads for after a step; where the step has ended that, or news has taken it
// back, what it headed for before, or what the record says.
function pursuitsFrom(history, before, after, step) {
  const pursued = pursuedIn(history, step);
  return Int32Array.from(after.team, (slot, robot) => {
    if (slot === NOBODY) return NOBODY;
    if (pursued.has(slot)) return pursued.get(slot);
    if (after.task[slot] !== NOBODY) return after.task[slot];
    return before.team[robot] === NOBODY ? NOBODY : before.task[before.team[robot]];
  });
}

// Also those whose team lost its lowest robot in the same step, and goes by another since.
function robotsForming(before, { splits = [], joins = [] }) {
  const forming = new Set(splits.flat(2));
  if (!joins.length) return forming;
  const parted = { ...before, team: before.team.slice() };
  for (const part of splits.flat()) for (const robot of part) parted.team[robot] = Math.min(...part);
  const slots = new Set(joins.flat());
  parted.team.forEach((slot, robot) => slots.has(slot) && forming.add(robot));
  return forming;
}

// What teams do for tasks in a step, by slot. A service that began at the end of a step takes the
// steps after it, up to the one that ends it; whoever has joined those that began it serves with them.
function workOfTeams(history, after, step) {
  const work = new Map();
  history.services.forEach((services, task) => {
    for (const service of services) {
      if (step <= service.from || service.to < step) continue;
      for (const robot of robotsServing(service, step)) {
        const [slot, does] = [after.team[robot], workOn(history, task, step)];
        if (does !== SERVES || !work.has(slot)) work.set(slot, does); // who has a load does only that
      }
    }
  });
  return work;
}

// What a team does for a task that it serves in a step.
function workOn(history, task, step) {
  const { to, unload } = history.mission.tasks[task];
  if (!to) return SERVES;
  if (!sitesAt(history, step - 1)[task].isUp) return LOADS;
  return step > history.doneAt[task] - unload ? UNLOADS : CARRIES;
}

// The runs of one phase for one task in a robot's time: [{phase, task, from, to}], `from` excluded.
export function phaseRuns(history, robot) {
  const runs = [];
  for (let step = 1; step <= history.last; step++) {
    const phase = phasesIn(history, step)[robot];
    const task = pursuitsIn(history, step)[robot];
    const run = runs.at(-1);
    if (run?.phase === phase && run.task === task) run.to = step;
    else runs.push({ phase, task, from: step - 1, to: step });
  }
  return runs;
}

// The tasks that each robot has done, by robot: [{task, step}] in their order.
export function deedsOfRobots({ mission, doers, doneAt }) {
  const deeds = mission.robots.map(() => []);
  doers.forEach((robots, task) => {
    for (const robot of robots) deeds[robot].push({ task, step: doneAt[task] });
  });
  for (const row of deeds) row.sort((one, other) => one.step - other.step || one.task - other.task);
  return deeds;
}

// The part of the steps up to one that each robot spent in each phase, by robot and phase.
export function phaseShares(history, step) {
  const shares = history.mission.robots.map(() => new Float64Array(PHASES.length));
  for (let made = 1; made <= step; made++) {
    phasesIn(history, made).forEach((phase, robot) => shares[robot][phase]++);
  }
  for (const row of shares) row.forEach((steps, phase) => (row[phase] = step ? steps / step : 0));
  return shares;
}
