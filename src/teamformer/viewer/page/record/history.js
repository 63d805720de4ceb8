// From the deltas of a record to the state after any step, and to the list of what happened.

import { framesOfEvents } from "./continuous.js";
import { rememberLast } from "./keeping.js";
import { readMission, shareSites } from "./mission.js";
import { inSquares, stepInSquares } from "./plane.js";
import { NOBODY, applyStep, copyState, fillHeadings, formTeams, loseRobot, placeOf, placeTeams, robotsOfTeam, startState } from "./state.js";
import { CARRYING, LOADING, SERVING, UNLOADING, hearTold, readTold } from "./told.js";

const KEYFRAME_EVERY = 50;
const STATES_KEPT = 40;

// Read a record once; then `at(step)` gives the state after that many steps, or at a tick of continuous
// time (`tick`, if it is that of another record). Memory stays bounded: a state every KEYFRAME_EVERY
// steps and the few last asked for, whatever the length.
/** @returns {TrialHistory} */
export function frames(/** @type {any} */ recorded, /** @type {number | undefined} */ tick = undefined) {
  const history = recorded.events ? framesOfEvents(recorded, tick) : framesOfSteps(recorded);
  history.sitesAfter = rememberLast(STATES_KEPT, (count) => sitesAfter(history, count));
  if (history.end.status !== "running") history.events.push({ step: history.last, ...(history.isContinuous ? { when: history.until } : {}), kind: "end" });
  return history;
}

function framesOfSteps(recorded) {
  fillHeadings(recorded.steps);
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
    told: readTold(record, mission),
    doneAt: mission.tasks.map(() => Infinity),
    overAt: mission.tasks.map(({ cancelled }) => cancelled), // the step in which it is done, called off or missed
    missed: new Map(), // why tasks are missed
    doers: mission.tasks.map(() => []), // the robots of the team that did it
    shownAt: mission.tasks.map(({ mayNeed }) => (mayNeed.length ? Infinity : 0)),
    foundAt: mission.tasks.map(({ within }) => (within ? Infinity : 0)),
    moves: [], // {step, task, at, isUp} of tasks that are elsewhere from then on, or believed to be
    absences: mission.robots.map(() => []), // [{from, to, place}], steps; `to` is open till it is back
    headings: mission.robots.map(() => NOBODY), // by slot, the task last headed for
    leaving: new Map(), // of a live mission: robot -> its absence from the next step on
  };
  history.at = rememberLast(STATES_KEPT, (step) => stateAt(history, step));
  const take = stepTaker(history);
  record.steps.forEach((change, index) => take(change, index + 1));
  history.grow = (change, told, end) => grow(history, take, change, told, end);
  return history;
}

// One step more of a mission that runs, and what is told of it; `end` says how it ended, if it did.
function grow(/** @type {TrialHistory} */ history, take, /** @type {StepTree} */ change, told, end) {
  const step = stepInSquares(history.mission.world, change);
  history.record.steps.push(step);
  history.last++;
  if (history.leaving.size) history.leaving = new Map(); // the step says that they are lost
  hearTold(history.told, told);
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

// Returns what to call with each step in turn: keyframes, events, places of loads, completions, losses.
function stepTaker(/** @type {TrialHistory} */ history) {
  const { record, mission } = history;
  const later = [...mission.tasks.keys()].filter((task) => mission.tasks[task].appears > 0);
  const arrivals = Map.groupBy(later, (task) => mission.tasks[task].appears);
  const state = startState(record, mission);
  history.keyframes.push(copyState(state));
  return (change, step) => {
    recordStep(history, state, change, step);
    recordServices(history, state, change, step);
    recordCompletions(history, state, change, step);
    for (const task of cancelledIn(history, step)) history.events.push({ step, kind: "cancelled", task });
    for (const task of arrivals.get(step) ?? []) {
      if (step < mission.tasks[task].cancelled) history.events.push({ step, kind: "appears", task });
    }
    if (step % KEYFRAME_EVERY === 0) history.keyframes.push(copyState(state));
  };
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

// Services that begin in a step, and where loads are: those that are up where they are brought, and
// `isUp`, until they are done or set down.
function recordServices(/** @type {TrialHistory} */ history, /** @type {State} */ state, /** @type {StepTree} */ change, step) {
  const { mission, moves, events, told } = history;
  const began = told.rows.filter(({ from }) => from === step);
  for (const service of began) if (service.slot !== null) service.began = robotsOfTeam(state, service.slot);
  const isUp = ({ doing }) => doing === CARRYING || doing === UNLOADING;
  for (const service of told.rows.filter((row) => row.to === step && isUp(row))) {
    const { task } = service;
    if (change.done?.some(([done]) => done === task) || began.some((row) => row.task === task && row.doing === UNLOADING)) continue;
    const at = placeLeft(state, change, service);
    moves.push({ step, task, at });
    events.push({ step, kind: "left", task, at });
  }
  for (const { task, doing, from, to, began: robots } of began) {
    if (doing === LOADING || (doing === SERVING && from < to)) events.push({ step, kind: "begins", task, robots });
    if (doing !== CARRYING) continue;
    events.push({ step, kind: "taken", task, robots });
    moves.push({ step, task, at: goalOf(mission, task), isUp: true });
  }
  for (const [task] of change.done ?? []) if (mission.tasks[task].to) moves.push({ step, task, at: goalOf(mission, task) });
}

// Where a load lies that was set down: as the step says, or where its robots are.
/** @returns {Place} */
function placeLeft(/** @type {State} */ state, /** @type {StepTree} */ { left = [] }, /** @type {Service} */ { task, began, ended }) {
  const said = left.find(([other]) => other === task);
  if (said) return [said[1], said[2]];
  const there = [...ended, ...began].find((robot) => state.team[robot] !== NOBODY) ?? began[0];
  const slot = state.team[there] === NOBODY ? there : state.team[there];
  return [state.x[slot], state.y[slot]];
}

// Where a load is brought.
function goalOf(/** @type {Mission} */ { tasks }, task) {
  return tasks[task].to ?? tasks[task].at;
}

// Where tasks are believed to be after a step: by task {at, mates}, as in the mission.
export function sitesAt(/** @type {TrialHistory} */ history, step) {
  const { moves, mission } = history;
  if (!mission.doTasksMove) return mission.tasks;
  let count = moves.length;
  while (count > 0 && moves[count - 1].step > step) count--;
  return history.sitesAfter(count);
}

// The same after the first moves.
function sitesAfter(/** @type {TrialHistory} */ { moves, mission }, count) {
  const sites = mission.tasks.map(({ first }) => ({ at: first }));
  for (const { task, at, isUp } of moves.slice(0, count)) Object.assign(sites[task], { at, isUp });
  return shareSites(sites);
}

function recordFormations(/** @type {TrialHistory} */ { events }, /** @type {State} */ state, /** @type {StepTree} */ change, step) {
  for (const [stay, leave] of change.splits ?? []) events.push({ step, kind: "split", stay, leave, robots: [...stay, ...leave] });
  for (const pair of change.joins ?? []) {
    const [joiner, partner] = pair.map((slot) => robotsOfTeam(state, slot));
    events.push({ step, kind: "join", joiner, partner, robots: [...joiner, ...partner] });
  }
}

function recordLoss(/** @type {TrialHistory} */ history, /** @type {State} */ state, robot, step) {
  const { x, y } = placeOf(state, robot);
  history.absences[robot].push({ from: step, to: Infinity, place: [x, y] });
  const mates = robotsOfTeam(state, state.team[robot]).filter((mate) => mate !== robot);
  history.events.push({ step, kind: "lost", robots: [robot, ...mates] });
  loseRobot(state, robot);
}

function recordReturn(/** @type {TrialHistory} */ history, /** @type {State} */ state, robot, step) {
  for (const absence of history.absences[robot].slice(-1)) absence.to = step;
  state.team[robot] = robot;
  history.events.push({ step, kind: "back", robots: [robot] });
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
    events.push({ step, kind: "heads", task, robots: robotsOfTeam(state, slot) });
  }
}

function recordCompletions(/** @type {TrialHistory} */ history, /** @type {State} */ state, /** @type {StepTree} */ change, step) {
  for (const [task, doer] of change.done ?? []) {
    history.doneAt[task] = history.overAt[task] = step;
    history.doers[task] = doer === null ? [] : robotsOfTeam(state, doer); // of a fleet nobody may know who did it
    history.events.push({ step, kind: "done", task, robots: history.doers[task] });
  }
  for (const [task, why] of change.missed ?? []) {
    history.overAt[task] = step;
    history.missed.set(task, why);
    history.events.push({ step, kind: "missed", task, why });
  }
}

// The tasks that are called off in a step.
function cancelledIn(/** @type {TrialHistory} */ { mission, doneAt, missed }, step) {
  const all = mission.tasks.map((_, task) => task);
  return all.filter((task) => mission.tasks[task].cancelled === step && doneAt[task] === Infinity && !missed.has(task));
}
