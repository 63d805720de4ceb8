// From the deltas of a record to the state after any step, and to the list of what happened.

import { covers } from "./counts.js";
import { readMission, shareSites, windowOpens } from "./mission.js";
import { inSquares, stepInSquares } from "./plane.js";
import { robotsServing, serviceKeeper, takenIn } from "./services.js";
import { NOBODY, applyStep, copyState, countsOfTeam, formTeams, loseRobot, placeOf, placeTeams, robotsOfTeam, sizeOf, startState, teamSizes } from "./state.js";

const KEYFRAME_EVERY = 50;
const STATES_KEPT = 40;
export const NEWS = ["appears", "cancelled", "lost", "back", "found", "shown"]; // events after which it is planned anew

// Read a record once; then `at(step)` gives the state after that many steps. Memory stays bounded:
// a state every KEYFRAME_EVERY steps and the few last asked for, whatever the length.
export function frames(recorded) {
  const record = inSquares(recorded);
  const mission = readMission(record.mission, record.truth, record.foresight);
  /** @type {any} */ const history = {
    record,
    mission,
    last: record.steps.length,
    end: record.end,
    lowerBound: record.lower_bound ?? null,
    hasMessages: record.steps.some(({ heard }) => heard),
    keyframes: [],
    events: [],
    services: mission.tasks.map(() => []), // [{slot, from, to, robots, leftIn}], steps; `to` is open till it ends
    doneAt: mission.tasks.map(() => Infinity),
    overAt: mission.tasks.map(({ cancelled }) => cancelled), // the step in which it is done or called off
    doneBy: mission.tasks.map(() => NOBODY),
    doers: mission.tasks.map(() => []), // the robots of the team that did it
    shownAt: mission.tasks.map(({ mayNeed }) => (mayNeed.length ? Infinity : 0)),
    foundAt: mission.tasks.map(({ within }) => (within ? Infinity : 0)),
    moves: [], // {step, task, at, isUp} of tasks that are elsewhere from then on, or believed to be
    lies: mission.tasks.map(({ at }) => at), // where tasks really are; loads where they were taken up
    carriedBy: new Map(), // load -> the slot of the team that has it up after the latest step read
    absences: mission.robots.map(() => []), // [{from, to, place}], steps; `to` is open till it is back
    headings: mission.robots.map(() => NOBODY), // by slot, the task last headed for
    leaving: new Map(), // of a live mission: robot -> its absence from the next step on
    sitesLeft: null, // where tasks are after the latest step then, once asked for
  };
  history.at = rememberLast(STATES_KEPT, (step) => stateAt(history, step));
  history.sitesAfter = rememberLast(STATES_KEPT, (count) => sitesAfter(history, count));
  const take = stepTaker(history);
  record.steps.forEach((change, index) => take(change, index + 1));
  if (history.end.status !== "running") history.events.push({ step: history.last, kind: "end" });
  history.grow = (change, end) => grow(history, take, change, end);
  return history;
}

// One step more of a mission that runs; `end` says how it ended, if it did.
function grow(/** @type {TrialHistory} */ history, take, /** @type {StepTree} */ change, end) {
  const step = stepInSquares(history.mission.world, change);
  history.record.steps.push(step);
  history.last++;
  if (history.leaving.size) history.leaving = new Map(); // the step says that they are lost
  history.sitesLeft = null;
  take(step, history.last);
  if (!end) return;
  history.end = history.record.end = end;
  history.events.push({ step: history.last, kind: "end" });
}

// From the nearest keyframe, or from the state asked for last if that is on the way.
function stateAt(/** @type {TrialHistory} */ history, step) {
  const key = Math.floor(step / KEYFRAME_EVERY);
  const keyframe = { step: key * KEYFRAME_EVERY, state: history.keyframes[key] };
  const { latest } = history;
  const near = latest && latest.step > keyframe.step && latest.step <= step ? latest : keyframe;
  const state = copyState(near.state);
  for (let done = near.step; done < step; done++) applyStep(state, history.record.steps[done]);
  history.latest = { step, state };
  return state;
}

/**
 * Returns what gives the value of a key, which is made once while the key is one of the last ones.
 * @template Key, Value
 * @param {number} kept
 * @param {(key: Key) => Value} make
 * @returns {(key: Key) => Value}
 */
export function rememberLast(kept, make) {
  const known = new Map();
  return (key) => {
    if (!known.has(key)) {
      if (known.size >= kept) known.delete(known.keys().next().value);
      known.set(key, make(key));
    }
    return known.get(key);
  };
}

// Returns what to call with each step in turn: keyframes, events, services, completions, losses.
function stepTaker(/** @type {TrialHistory} */ history) {
  const { record, mission } = history;
  const keepServices = serviceKeeper(history);
  const arrivals = arrivalsByStep(mission);
  const state = startState(record, mission);
  history.keyframes.push(copyState(state));
  return (change, step) => {
    recordStep(history, state, change, step);
    recordLoads(history, change, step);
    keepServices(state, change, step);
    for (const [task, slot] of takenIn(history, change, step)) {
      history.events.push({ step, kind: "taken", task, slot, size: sizeOf(state, slot) });
    }
    recordCompletions(history, state, change, step);
    const cancelled = cancelledIn(history, step);
    for (const task of cancelled) history.events.push({ step, kind: "cancelled", task });
    if (change.done || cancelled.length) openNextTasks(history, step);
    for (const task of arrivals.get(step) ?? []) {
      history.events.push({ step, kind: "appears", task });
    }
    if (step % KEYFRAME_EVERY === 0) history.keyframes.push(copyState(state));
  };
}

function arrivalsByStep(/** @type {Mission} */ mission) {
  const arrivals = new Map();
  mission.tasks.forEach(({ appears, cancelled }, task) => {
    if (appears > 0 && appears < cancelled) arrivals.set(appears, [...(arrivals.get(appears) ?? []), task]);
  });
  return arrivals;
}

// Tasks may begin when the last task that they are after is over.
function openNextTasks(/** @type {TrialHistory} */ { mission, record, overAt }, step) {
  mission.tasks.forEach((task, number) => {
    if (task.opens < Infinity || task.after.some((other) => overAt[other] > step)) return;
    task.opens = Math.max(windowOpens(record.mission.tasks[number].between), step);
  });
}

function recordStep(/** @type {TrialHistory} */ history, /** @type {State} */ state, /** @type {StepTree} */ change, step) {
  if (change.splits || change.joins) recordFormations(history, state, change, step);
  formTeams(state, change);
  for (const robot of change.lost ?? []) recordLoss(history, state, robot, step);
  for (const robot of change.back ?? []) recordReturn(history, state, robot, step);
  placeTeams(state, change);
  for (const task of change.shown ?? []) {
    history.shownAt[task] = step;
    history.events.push({ step, kind: "shown", task });
  }
  for (const [task, ...at] of change.moved ?? []) history.moves.push({ step, task, at });
  for (const task of change.found ?? []) {
    history.foundAt[task] = step;
    history.events.push({ step, kind: "found", task });
  }
  recordHeadings(history, state, change, step);
}

// Loads that are taken up are where they are brought, and `isUp`, until they are done or set down.
function recordLoads(/** @type {TrialHistory} */ history, /** @type {StepTree} */ change, step) {
  const { mission, moves, events, lies, carriedBy } = history;
  for (const [task, ...at] of change.left ?? []) {
    moves.push({ step, task, at });
    events.push({ step, kind: "left", task, at });
    lies[task] = at;
    carriedBy.delete(task);
  }
  for (const [task, slot] of takenIn(history, change, step)) {
    moves.push({ step, task, at: goalOf(mission, task), isUp: true });
    carriedBy.set(task, slot);
  }
  for (const [task] of change.done ?? []) {
    carriedBy.delete(task); // or it was taken up and brought in this step
    if (mission.tasks[task].to) moves.push({ step, task, at: goalOf(mission, task) });
  }
}

// Where a load is brought.
function goalOf(/** @type {Mission} */ { tasks }, task) {
  return tasks[task].to ?? tasks[task].at;
}

// Where tasks are believed to be after a step: by task {at, mates}, as in the mission.
export function sitesAt(/** @type {TrialHistory} */ history, step) {
  const { moves, mission } = history;
  if (!mission.doTasksMove) return mission.tasks;
  if (step >= history.last && history.leaving.size) return (history.sitesLeft ??= sitesLeft(history));
  let count = moves.length;
  while (count > 0 && moves[count - 1].step > step) count--;
  return history.sitesAfter(count);
}

// The same after the latest step where robots leave: who cannot carry a load without them sets it down.
function sitesLeft(/** @type {TrialHistory} */ history) {
  const { last, services } = history;
  const state = history.at(last);
  const sites = history.sitesAfter(history.moves.length).map(({ at, isUp }, task) => {
    if (!isUp || serviceOf(history, task, last)) return { at, isUp };
    const { slot } = services[task].at(-1);
    return { at: [state.x[slot], state.y[slot]] };
  });
  return shareSites(sites);
}

// The same after the first moves.
function sitesAfter(/** @type {TrialHistory} */ { moves, mission }, count) {
  const sites = mission.tasks.map(({ first }) => ({ at: first }));
  for (const { task, at, isUp } of moves.slice(0, count)) Object.assign(sites[task], { at, isUp });
  return shareSites(sites);
}

function recordFormations(/** @type {TrialHistory} */ { events }, /** @type {State} */ state, /** @type {StepTree} */ change, step) {
  const sizes = teamSizes(state);
  for (const [stay, leave] of change.splits ?? []) {
    events.push({ step, kind: "split", slot: state.team[stay[0]], stay, leave });
  }
  for (const [joiner, partner] of change.joins ?? []) {
    const [joiners, partners] = [sizes[joiner], sizes[partner]];
    events.push({ step, kind: "join", joiner, partner, joiners, partners });
  }
}

// `heir` is the slot of the robot's team from then on.
function recordLoss(/** @type {TrialHistory} */ history, /** @type {State} */ state, robot, step) {
  const slot = state.team[robot];
  /** @type {Place} */ const place = [state.x[slot], state.y[slot]];
  history.absences[robot].push({ from: step, to: Infinity, place });
  const mate = state.team.findIndex((other, number) => other === slot && number !== robot);
  loseRobot(state, robot);
  history.events.push({ step, kind: "lost", robot, slot, heir: state.team[mate] ?? NOBODY });
}

function recordReturn(/** @type {TrialHistory} */ history, /** @type {State} */ state, robot, step) {
  for (const absence of history.absences[robot].slice(-1)) absence.to = step;
  state.team[robot] = robot;
  history.events.push({ step, kind: "back", robot, slot: robot, size: 1 });
}

// What everybody believes that a task needs after a step.
export function needsAt(/** @type {TrialHistory} */ history, task, step) {
  const { needs, believed } = history.mission.tasks[task];
  return history.shownAt[task] <= step ? needs : believed;
}

// Since when and where a robot is lost at a step; undefined while it is there.
export function absenceAt(/** @type {TrialHistory} */ history, robot, step) {
  const leaving = step >= history.last && history.leaving.get(robot);
  return leaving || history.absences[robot].find(({ from, to }) => from <= step && step < to);
}

// Where a lost robot lies.
export function placeLost(/** @type {TrialHistory} */ history, robot, step) {
  return /** @type {Absence} */ (absenceAt(history, robot, step)).place;
}

export function isLost(/** @type {TrialHistory} */ history, robot, step) {
  return absenceAt(history, robot, step) !== undefined;
}

// The robots of a live mission that count for nothing from the next step on: whatever is shown of
// the latest step has them lost already.
export function leave(/** @type {TrialHistory} */ history, robots) {
  if ([...history.leaving.keys()].join() === robots.join()) return;
  const state = history.at(history.last);
  const from = history.last + 1;
  history.sitesLeft = null;
  history.leaving = new Map(
    robots.map((robot) => {
      const { x, y } = placeOf(state, robot);
      return [robot, { from, to: Infinity, place: [x, y] }];
    }),
  );
}

// The state that is shown after a step: as recorded, without robots that are leaving.
export function stateShown(/** @type {TrialHistory} */ history, step) {
  const state = history.at(step);
  if (step < history.last || !history.leaving.size) return state;
  const left = copyState(state);
  for (const robot of history.leaving.keys()) loseRobot(left, robot);
  return left;
}

export function robotsLostAt(/** @type {TrialHistory} */ history, step) {
  return [...history.absences.keys()].filter((robot) => isLost(history, robot, step));
}

// Teams that lose their assignment and get the same again have not changed their minds.
function recordHeadings(/** @type {TrialHistory} */ { events, headings }, /** @type {State} */ state, /** @type {StepTree} */ change, step) {
  for (const [slot, , , task] of change.teams ?? []) {
    if (task === null || headings[slot] === task) continue;
    headings[slot] = task;
    events.push({ step, kind: "heads", slot, task, size: sizeOf(state, slot) });
  }
}

function recordCompletions(/** @type {TrialHistory} */ history, /** @type {State} */ state, /** @type {StepTree} */ change, step) {
  for (const [task, doer] of change.done ?? []) {
    const slot = doer ?? NOBODY; // of a fleet nobody may know who did it
    history.doneAt[task] = history.overAt[task] = step;
    history.doneBy[task] = slot;
    history.doers[task] = slot === NOBODY ? [] : robotsOfTeam(state, slot);
    history.events.push({ step, kind: "done", task, slot, size: history.doers[task].length });
  }
}

// The tasks that are called off in a step.
function cancelledIn(/** @type {TrialHistory} */ { mission, doneAt }, step) {
  const all = mission.tasks.map((_, task) => task);
  return all.filter((task) => mission.tasks[task].cancelled === step && doneAt[task] === Infinity);
}

// What teams pursued in a step whose assignments neither before nor after it say so: news took them back.
export function pursuedIn(/** @type {TrialHistory} */ { record }, step) {
  return new Map(record.steps[step - 1].pursued ?? []);
}

// The service of a task that goes on after a step, with the robots that are with it then; null if
// there is none, or it is broken off because a robot leaves.
export function serviceOf(/** @type {TrialHistory} */ history, task, step) {
  const service = history.services[task].find(({ from, to }) => from <= step && step < to);
  if (!service) return null;
  const { mission } = history;
  const state = stateShown(history, step);
  const robots = robotsServing(service, step + 1).filter((robot) => state.team[robot] !== NOBODY);
  const slot = state.team[robots[0]];
  const isLeft = step >= history.last && history.leaving.size > 0;
  if (isLeft && !(robots.length && covers(countsOfTeam(mission, state, slot), mission.tasks[task].needs))) return null;
  return { ...service, slot, robots };
}
