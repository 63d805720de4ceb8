// A record in continuous time as the page holds any record: the state at every tick, and what happened.

import { rememberLast } from "./keeping.js";
import { readMission } from "./mission.js";
import { missionInSquares, squareOf, truthInSquares } from "./plane.js";
import { laidOut, worldOfRoads } from "./roads.js";
import { emptyState } from "./state.js";
import { AT_WORK, FORMING, LOST, WALKING, hearTold, listIn, readTold, runsOf } from "./told.js";
import { Track } from "./tracks.js";
import { inTicks, tickFor } from "./ticks.js";

const MOMENTS_KEPT = 40;
const TRAIL = 30; // ticks
const UNPLANNED = 100; // units that a mission is to take whose plan does not say

// `tick` is that of a record beside which this one is shown. The record of a mission that runs says what
// time it is `now`, and has ticks for the time that its first plan takes.
/** @returns {any} */
export function framesOfEvents(/** @type {any} */ recorded, tick = tickFor(lengthOf(recorded))) {
  const { mission, placeOf } = missionShown(recorded, tick);
  const events = recorded.events.map(([at, kind, said]) => inPlace({ at: at / tick, kind, ...said }, tick, placeOf));
  const until = recorded.now === undefined ? (events.at(-1)?.at ?? 0) : recorded.now / tick;
  const none = mission.tasks.map(() => Infinity);
  const history = {
    record: { ...recorded, steps: [], start: [], ...plansOf(events) },
    mission,
    isContinuous: true,
    last: tickAt(until),
    until,
    trail: TRAIL,
    end: inTicksOf(recorded.end, tick),
    lowerBound: recorded.lower_bound === null ? null : recorded.lower_bound / tick,
    hasMessages: false,
    keyframes: [],
    latest: null,
    events: [],
    told: readTold({ ...recorded, told: toldInTicks(recorded.told, tick) }, mission),
    doneAt: [...none],
    overAt: [...none],
    missed: new Map(),
    doers: mission.tasks.map(() => []),
    shownAt: mission.tasks.map(({ mayNeed }) => (mayNeed.length ? Infinity : 0)),
    foundAt: mission.tasks.map(({ within }) => (within ? Infinity : 0)),
    moves: [],
    absences: mission.robots.map(() => []),
    headings: [],
    leaving: new Map(),
    tracks: mission.robots.map(({ at }) => new Track(at)),
    grow: (/** @type {any} */ news) => growBy(/** @type {any} */ (history), news, tick, placeOf),
  };
  for (const event of events) take(history, event);
  keepStates(history);
  return history;
}

function keepStates(history) {
  history.at = rememberLast(MOMENTS_KEPT, (step) => standingAt(history, step));
}

// How long a record is; of a mission that runs, how long it is to be by its first plan.
function lengthOf({ now, events }) {
  if (now === undefined) return events.at(-1)?.[0] ?? 0;
  const [, tasks] = events.find(([, kind]) => kind === "plan")?.[2].plan ?? [[], []];
  const ends = tasks.map(([, , end]) => end ?? 0);
  return Math.max(...ends, 0) || Math.max(now, UNPLANNED);
}

// The tick in which a moment is shown that lies within it.
function tickAt(moment) {
  return Math.ceil(moment - 1e-6);
}

// More of a mission that runs: it is later, something has happened, it has ended.
function growBy(/** @type {TrialHistory} */ history, { now, events, told, end }, tick, placeOf) {
  const rows = events.map(([at, kind, said]) => inPlace({ at: at / tick, kind, ...said }, tick, placeOf));
  for (const event of rows) take(history, event);
  const { orders, plans } = plansOf(rows);
  history.record.orders.push(...orders);
  history.record.plans?.push(...plans);
  if (told) hearTold(history.told, newsInTicks(told, tick));
  history.until = now / tick;
  history.last = tickAt(history.until);
  if (end) {
    history.end = history.record.end = inTicksOf(end, tick);
    history.events.push({ step: history.last, when: history.until, kind: "end" });
  }
  history.told.runs.clear();
  history.leaving = new Map(); // scenes are worked out anew
  keepStates(history);
}

// The mission with times in ticks and places in squares, and what gives the place of an event.
function missionShown(/** @type {any} */ recorded, tick) {
  const { world } = recorded.mission;
  const timed = inTicks(recorded.mission, recorded.truth, tick);
  if (world.roads) {
    const { mission, truth, map } = laidOut(timed.mission, timed.truth, recorded.told);
    const read = readMission(mission, truth, recorded.foresight, worldOfRoads(map));
    return { mission: onClock(read, tick), placeOf: ([number]) => map.places[number] };
  }
  if (!world.plane) return { mission: onClock(readMission(timed.mission, timed.truth, recorded.foresight), tick), placeOf: (at) => at };
  const square = squareOf(world);
  const read = readMission(missionInSquares(timed.mission, square), truthInSquares(timed.truth, square), recorded.foresight);
  return { mission: onClock(read, tick), placeOf: (at) => at.map((along) => along / square) };
}

function onClock(/** @type {Mission} */ mission, tick) {
  Object.assign(mission.world, { stepSeconds: tick, isTimed: true, secondsUnit: "" });
  return mission;
}

function inPlace(event, tick, placeOf) {
  const { place, way, until } = event;
  return {
    ...event,
    until: until === undefined ? event.at : until / tick,
    place: place && placeOf(place),
    way: way?.map(([at, passed]) => [at / tick, placeOf(passed)]),
  };
}

function inTicksOf(/** @type {any} */ end, tick) {
  return { ...end, makespan: end.makespan === null ? null : end.makespan / tick };
}

// What is told, with all times in ticks.
function toldInTicks(told, tick) {
  if (!told) return told;
  const timed = (rows, places) => listIn(rows).map((row) => rowInTicks(row, places, tick));
  return {
    ...told,
    services: timed(told.services, [2, 3]),
    phases: listIn(told.phases).map((own) => timed(own, [0])),
    path: timed(told.path, [0, 1]),
    charge: listIn(told.charge).map((own) => listIn(own).map((row) => levelInTicks(row, tick))),
  };
}

// What is told of a moment: rows with their numbers, or with their robots.
function newsInTicks(told, tick) {
  const timed = (rows, places) => rows.map(([key, row]) => [key, rowInTicks(row, places, tick)]);
  return {
    ...told,
    services: timed(told.services, [2, 3]),
    phases: timed(told.phases, [0]),
    path: listIn(told.path).map((row) => rowInTicks(row, [0, 1], tick)),
    charge: listIn(told.charge).map(([robot, row]) => [robot, levelInTicks(row, tick)]),
  };
}

// A row whose entries in some places are times; a time that is not known stays null.
function rowInTicks(row, /** @type {number[]} */ places, tick) {
  return row.map((value, place) => (places.includes(place) && typeof value === "number" ? value / tick : value));
}

// How full a battery is from a moment on, and by how much that changes in a tick.
function levelInTicks(row, tick) {
  const [begun, full, rate] = listIn(row);
  return [begun / tick, full, rate * tick];
}

// The plans as records in steps have them: coalitions by the tasks of an order.
function plansOf(events) {
  const made = events.filter(({ kind }) => kind === "plan");
  return {
    orders: made.map(({ at, plan: [, tasks] }) => [at, tasks.map(([task]) => task)]),
    plans: made.map(({ at, plan: [why, tasks] }) => [at, [why, tasks.map(([, robots]) => robots)]]),
  };
}

// Take in an event: where robots go, and how tasks stand.
function take(history, event) {
  const { at, kind, robots = [], task, place, way } = event;
  const { mission, tracks, moves, absences } = history;
  const tell = (what, more = {}) => history.events.push({ step: tickAt(at), when: at, kind: what, ...(task === undefined ? {} : { task }), ...more });
  switch (kind) {
    case "walk":
      for (const robot of robots) tracks[robot].setOut(at, way);
      if (task !== undefined) tell("heads", { robots });
      return;
    case "form":
      tell("forms", { robots });
      return;
    case "serve":
      if (event.until > at || mission.tasks[task].to) tell("begins", { robots });
      return;
    case "lift":
      for (const robot of robots) tracks[robot].setOut(at, way);
      moves.push({ step: at, task, at: mission.tasks[task].to, isUp: true });
      tell("taken", { robots });
      return;
    case "done":
      history.doneAt[task] = history.overAt[task] = at;
      history.doers[task] = robots;
      if (mission.tasks[task].to) moves.push({ step: at, task, at: mission.tasks[task].to });
      tell("done", { robots });
      return;
    case "broken":
      if (place) moves.push({ step: at, task, at: place });
      tell(place ? "left" : "broken", place ? { robots, at: place } : { robots });
      return;
    case "lost":
    case "empty":
      for (const robot of robots) {
        tracks[robot].stop(at);
        absences[robot].push({ from: at, to: Infinity, place: tracks[robot].placeAt(at) });
      }
      tell(kind, { robots });
      return;
    case "queue":
      tell("queues", { robots });
      return;
    case "charge":
      tell("charges", { robots });
      return;
    case "charged":
      tell("full", { robots });
      return;
    case "back":
      for (const robot of robots) for (const absence of absences[robot].slice(-1)) absence.to = at;
      tell("back", { robots });
      return;
    case "appear":
      tell("appears");
      return;
    case "cancel":
      history.overAt[task] = at;
      tell("cancelled");
      return;
    case "missed":
      history.overAt[task] = at;
      history.missed.set(task, event.why);
      tell("missed", { why: event.why });
      return;
    case "know":
      history.shownAt[task] = at;
      tell("shown");
      return;
    case "found":
      history.foundAt[task] = at;
      tell("found");
      moves.push({ step: at, task, at: place });
      return;
    case "moved":
      moves.push({ step: at, task, at: place });
  }
}

// How robots stand at a tick: those who form or work together are a team, and all others are alone.
/** @returns {State} */
function standingAt(/** @type {TrialHistory} */ history, step) {
  const { mission, tracks = [] } = history;
  const count = mission.robots.length;
  const state = emptyState(count);
  const teams = new Map();
  for (let robot = 0; robot < count; robot++) {
    const run = runsOf(history, robot).findLast(({ from }) => from <= step);
    [state.x[robot], state.y[robot]] = tracks[robot].placeAt(step);
    if (run?.phase === LOST) continue;
    const isTogether = run && (run.phase === FORMING || AT_WORK.includes(run.phase));
    if (isTogether && !teams.has(run.task)) teams.set(run.task, robot);
    state.team[robot] = isTogether ? teams.get(run.task) : robot;
    if (run) state.task[robot] = run.task;
  }
  return state;
}

// Where a team goes from a tick on, and when it is there; nothing if it stands.
export function wayAhead(/** @type {TrialHistory} */ history, robot, step) {
  const run = runsOf(history, robot).findLast(({ from }) => from <= step);
  if (!run || ![WALKING, "carrying"].includes(run.phase)) return null;
  return { places: history.tracks?.[robot].ahead(step, run.to) ?? [], until: run.to };
}
