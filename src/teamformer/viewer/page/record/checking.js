// Whether a record that somebody opens is whole: the keys and numbers that `view` and `check` ask for.
// @ts-nocheck

import { frames } from "./history.js";
import { criticalPath } from "./critical_path.js";
import { phasesIn } from "./phases.js";
import { sceneAt } from "./scene.js";
import { describeEvent } from "./words.js";

const NEEDED_KEYS = ["mission", "method", "seed", "orders", "start", "steps", "end", "lower_bound"];
const STATUSES = ["completed", "step limit", "infeasible", "interrupted"];
const END_COUNTS = ["steps", "tasks_done", "joins", "splits", "illegal_decisions"];

// By key of a step, what each row of its list holds: one value, or several.
const ROWS_OF_STEP = {
  joins: ["robot", "robot"],
  splits: ["robots", "robots"],
  lost: "robot",
  back: "robot",
  teams: ["robot", "number", "number", "goal"],
  done: ["task", "robot"],
  named: "robot",
  took: ["robot", "robot"],
  heard: ["robot", "robot", "word"],
  shown: "task",
  found: "task",
  moved: ["task", "number", "number"],
  taken: ["task", "robot"],
  left: ["task", "number", "number"],
  pursued: ["robot", "task"],
};

// Throws an Error that says where a record is damaged.
export function checkRecord(record) {
  for (const key of NEEDED_KEYS) if (record[key] === undefined) throw new Error(`'${key}' is missing`);
  const { mission, truth, steps, start, orders, end } = record;
  const listed = Array.isArray(mission?.tasks) && Array.isArray(mission.robots) && Array.isArray(mission.capabilities);
  if (!listed) throw new Error("its mission has no lists of robots, tasks and capabilities");
  const counts = { robot: mission.robots.length, task: mission.tasks.length + (truth?.arrivals?.length ?? 0) };
  checkRows(counts, start, ["robot", "robots", "number", "number"], "start");
  checkRows(counts, orders, ["count", "tasks"], "orders");
  if (!Array.isArray(steps)) throw new Error("its steps are no list");
  steps.forEach((step, index) => checkStep(counts, step, `step ${index + 1}`));
  checkEnd(end, steps.length);
}

function checkStep(counts, step, where) {
  if (typeof step !== "object" || step === null || Array.isArray(step)) throw new Error(`${where} is no mapping`);
  for (const [key, rows] of Object.entries(step)) {
    if (!(key in ROWS_OF_STEP)) throw new Error(`${where} has an unknown key '${key}'`);
    checkRows(counts, rows, ROWS_OF_STEP[key], `${where}, ${key}`);
  }
}

function checkEnd(end, steps) {
  if (!STATUSES.includes(end?.status)) throw new Error(`the status is ${JSON.stringify(end?.status)}`);
  const isCount = (value) => Number.isInteger(value) && value >= 0;
  for (const key of END_COUNTS) if (!isCount(end[key])) throw new Error(`'${key}' of its end is ${JSON.stringify(end[key])}`);
  if (end.makespan !== null && !isCount(end.makespan)) throw new Error(`the makespan is ${JSON.stringify(end.makespan)}`);
  if (!Array.isArray(end.blocked_tasks)) throw new Error("'blocked_tasks' of its end is no list");
  if (end.steps !== steps) throw new Error(`it has ${steps} steps, and its end says ${end.steps}`);
}

function checkRows(counts, rows, kinds, where) {
  if (!Array.isArray(rows)) throw new Error(`${where}: this is no list`);
  for (const row of rows) {
    const parts = Array.isArray(kinds) ? row : [row];
    const wanted = [kinds].flat();
    const isGood = Array.isArray(parts) && parts.length === wanted.length && wanted.every((kind, at) => isOfKind(counts, parts[at], kind));
    if (!isGood) throw new Error(`${where}: ${JSON.stringify(row)}`);
  }
}

function isOfKind(counts, value, kind) {
  const isBelow = (number, most) => Number.isInteger(number) && number >= 0 && number < most;
  switch (kind) {
    case "robot":
    case "task":
      return isBelow(value, counts[kind]);
    case "robots":
    case "tasks":
      return Array.isArray(value) && value.every((number) => isBelow(number, counts[kind.slice(0, -1)]));
    case "goal":
      return value === null || isBelow(value, counts.task);
    case "count":
      return isBelow(value, Infinity);
    case "number":
      return Number.isFinite(value);
    default:
      return typeof value === "string";
  }
}

// Reads a record as the page will, and throws what goes wrong on the way.
export function tryReading(record) {
  const history = frames(record);
  for (const event of history.events) describeEvent(history, event);
  if (history.last) phasesIn(history, history.last);
  sceneAt(history, history.last);
  criticalPath(history);
}
