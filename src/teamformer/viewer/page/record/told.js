// What a record tells of itself: services, phases of robots, reasons and the critical path. All of it was
// worked out before; the page only reads it.

import { NOBODY } from "./state.js";

export const PHASES = ["walking", "waiting", "forming", "serving", "loading", "carrying", "unloading", "idle", "lost", "off", "charging", "queueing"];
export const [WALKING, WAITING, FORMING, SERVING, LOADING, CARRYING, UNLOADING, IDLE, LOST, OFF, CHARGING, QUEUEING] = PHASES;
export const AT_WORK = [SERVING, LOADING, CARRYING, UNLOADING];

// What nobody has told is empty.
export function readTold(/** @type {RecordTree} */ { told = {} }, /** @type {Mission} */ { robots, tasks }) {
  /** @type {Told} */
  const read = { rows: [], services: tasks.map(() => []), phases: robots.map(() => []), texts: [], path: [], charge: robots.map(() => []), runs: new Map() };
  const { services, phases, texts, path, charge } = told ?? {};
  const byRobot = (rows) => listIn(rows).flatMap((own, robot) => listIn(own).map((row) => [robot, row]));
  hearTold(read, { services: [...listIn(services).entries()], phases: byRobot(phases), texts, path, charge: byRobot(charge) });
  return read;
}

// A list that whoever wrote it may have made something else.
export function listIn(value) {
  return Array.isArray(value) ? value : [];
}

// What is told of one more step: services by their number, phases by robot.
export function hearTold(/** @type {Told} */ told, /** @type {any} */ { services, phases, texts, path, charge }) {
  for (const [number, row] of listIn(services)) {
    const [task, doing, from, to, began, ended] = listIn(row);
    const known = told.rows[number];
    const service = { task, doing: PHASES[doing], from, to: to ?? Infinity, ended: listIn(ended) };
    told.rows[number] = Object.assign(known ?? whoBegan(began), service);
    if (!known) told.services[task]?.push(told.rows[number]);
  }
  for (const [robot, row] of listIn(phases)) told.phases[robot]?.push(listIn(row));
  for (const [robot, row] of listIn(charge)) told.charge[robot]?.push(listIn(row));
  for (const text of listIn(texts)) told.texts.push(text);
  for (const [from, to, doing, robot, task] of listIn(path).map(listIn)) told.path.push({ from, to, doing: PHASES[doing] ?? doing, robot: robot ?? NOBODY, task: task ?? NOBODY });
}

// Robots by their numbers, or a team by its slot: who is in it is known once its step is read.
function whoBegan(began) {
  return Array.isArray(began) ? { began, slot: null } : { began: [], slot: began };
}

// Rows of a robot from one step to another, each `{from, to, row}`. Where a robot's story is another's,
// these are the rows of that.
function partsOf(/** @type {any[][]} */ rows, robot, from, to) {
  return (rows[robot] ?? []).flatMap((row, at, all) => {
    const [begin, end] = [Math.max(from, row[0]), Math.min(to, all[at + 1]?.[0] ?? to)];
    if (begin >= end) return [];
    if (row[1] !== null) return [{ from: begin, to: end, row }];
    return row[2] < robot ? partsOf(rows, row[2], begin, end) : []; // a team is known by its lowest robot
  });
}

// What a robot did in all steps, worked out once for each length of the record.
/** @returns {Run[]} */
export function runsOf(/** @type {TrialHistory} */ history, robot) {
  const { told, last } = history;
  const known = told.runs.get(robot);
  if (known?.last === last) return known.runs;
  /** @type {Run[]} */ const runs = [];
  for (const { from, to, row } of partsOf(told.phases, robot, 0, endOf(history))) {
    const [run, phase, task] = [runs.at(-1), PHASES[row[1]], row[2] ?? NOBODY];
    if (run?.phase === phase && run.task === task) run.to = to; // alone, then with others
    else runs.push({ from, to, phase, task });
  }
  told.runs.set(robot, { last, runs });
  return runs;
}

// Until when all is told: a little later than now, if a mission runs in continuous time, so that what
// begins now is told.
function endOf(/** @type {TrialHistory} */ { isContinuous, end, last, until = last }) {
  return isContinuous && end.status === "running" ? until + INSTANT : until;
}

const INSTANT = 1e-6; // ticks

// What a robot does after a step; after the last one, what it did in that or, while the mission runs in
// continuous time, what it does. Nothing if nobody tells.
export function runAfter(/** @type {TrialHistory} */ history, robot, step) {
  const { last, until = last } = history;
  const made = endOf(history) > until ? Math.min(step, until) : Math.min(step, last - 1);
  return runsOf(history, robot).find(({ from, to }) => from <= made && made < to);
}

// How full the battery of a robot is at a moment, 0 to 1; nothing if it has none.
export function chargeAt(/** @type {TrialHistory} */ { told }, robot, step) {
  const row = (told.charge[robot] ?? []).findLast(([begun]) => begun <= step);
  if (!row) return null;
  const [begun, full, rate] = row;
  return Math.min(1, Math.max(0, full + rate * (step - begun)));
}

// The reasons for what a robot does after a step, as a sentence without its end: those for what it does
// next or, where that goes without saying, for what it did.
export function reasonFor(/** @type {TrialHistory} */ history, robot, step) {
  const { told } = history;
  const parts = partsOf(told.phases, robot, Math.max(0, step - 1), Math.min(step + 1, endOf(history)));
  const reasons = parts.map(({ row }) => row.slice(3).map((text) => told.texts[text]).join("; "));
  return reasons.findLast((reason) => reason) ?? "";
}

// The service of a task that goes on after a step, with the robots that are at it then; null if there is none.
export function serviceAfter(/** @type {TrialHistory} */ history, task, step) {
  const service = history.told.services[task].find(({ from, to }) => from <= step && step < to);
  if (!service) return null;
  const robots = service.began.filter((robot) => AT_WORK.includes(runAfter(history, robot, step)?.phase ?? LOST));
  return { ...service, robots: robots.length ? robots : service.began };
}

// By phase, how many of the first steps a robot spent in it.
export function stepsInPhases(/** @type {TrialHistory} */ history, robot, step) {
  const steps = new Map(PHASES.map((phase) => [phase, 0]));
  for (const { phase, from, to } of runsOf(history, robot)) {
    if (from < step) steps.set(phase, Number(steps.get(phase)) + Math.min(to, step) - from);
  }
  return steps;
}

// The tasks that each robot has done, by robot: [{task, step}] in their order.
export function deedsOfRobots(/** @type {TrialHistory} */ { mission, doers, doneAt }) {
  /** @type {{task: number, step: number}[][]} */ const deeds = mission.robots.map(() => []);
  doers.forEach((robots, task) => {
    for (const robot of robots) deeds[robot].push({ task, step: doneAt[task] });
  });
  for (const row of deeds) row.sort((one, other) => one.step - other.step || one.task - other.task);
  return deeds;
}
