// The columns of the tables: what each says of a task or a robot, and by what it sorts.

import { isLost } from "../record/history.js";
import { describeSpan, percent, shortMoment } from "../record/lengths.js";
import { hasDueTimes } from "../record/mission.js";
import { sharedPlanAt } from "../record/plans.js";
import { isOver, standingOf, teamOfRobot } from "../record/scene.js";
import { NOBODY } from "../record/state.js";
import { IDLE, deedsOfRobots, serviceAfter, stepsInPhases } from "../record/told.js";
import { describeCounts, describeNeeds, listRobots, robotName, taskName } from "../record/words.js";

// A cell is {text, sort, isAhead, whole}: numbers sort before words, what is absent last; what is ahead
// or expected is drawn paler. `whole` returns the text where the one shown is shorter: filters and files
// go by that. `isShown` says whether a mission has such a column at all.

const STATES = ["can never be done", "open", "waiting", "on the way", "under way", "to come", "called off", "missed", "done"];

export const TASK_COLUMNS = [
  { name: "Task", of: ({ mission }, task) => word(taskName(mission, task)) },
  { name: "State", of: (moment, task) => stateCell(stateOfTask(moment, task)) },
  { name: "Who", of: whoCell },
  { name: "End", of: endCell },
  { name: "Late", of: lateCell, isShown: hasDueTimes },
  { name: "Needs", of: needsCell },
];

export const ROBOT_COLUMNS = [
  { name: "Robot", of: ({ mission }, robot) => word(robotName(mission, robot)) },
  { name: "Doing", of: (moment, robot) => word(doingOf(moment, robot)) },
  { name: "Next", of: nextCell },
  { name: "Done", of: ({ deeds, step }, robot) => count(deeds[robot].filter((deed) => deed.step <= step).length) },
  { name: "Idle", of: idleCell },
  { name: "Brings", of: ({ mission }, robot) => word(describeCounts(mission, mission.robots[robot].can)) },
];

// What the cells of one moment have in common, worked out once.
export function momentOf(/** @type {App} */ app) {
  const { history } = app;
  const step = Math.min(app.player.step, history.last);
  const scene = app.scene();
  const plan = sharedPlanAt(history, step);
  const moment = { history, step, scene, plan, mission: history.mission, deeds: deedsOfRobots(history), next: new Map() };
  return { ...moment, next: nextTasks(moment) };
}

function word(text, isAhead = false) {
  return { text, sort: text.toLowerCase(), isAhead };
}

function count(number) {
  return { text: String(number), sort: number };
}

const NOTHING = { text: "-", sort: null, whole: () => "" };

// All that a cell says.
export function wholeText(/** @type {Cell} */ { text, whole }) {
  return whole ? whole() : text;
}

function robotsCell(/** @type {Mission} */ mission, robots, isAhead = false) {
  return { ...word(listRobots(mission, robots), isAhead), whole: () => listRobots(mission, robots, Infinity) };
}

function needsCell(/** @type {Moment} */ { history, step }, task) {
  return { ...word(describeNeeds(history, task, step)), whole: () => describeNeeds(history, task, step, Infinity) };
}

// One of STATES, for a task after a step.
function stateOfTask(/** @type {Moment} */ { history, scene }, task) {
  const standing = standingOf(history, task, scene.step);
  const words = { hidden: "to come", served: "under way", done: "done", cancelled: "called off", blocked: "can never be done" };
  if (standing === "cancelled" && history.missed.has(task)) return "missed";
  if (standing !== "open") return words[standing];
  const teams = scene.assignedTo.get(task) ?? [];
  if (!teams.length) return "open";
  return teams.some(({ activity }) => activity === "waits") ? "waiting" : "on the way";
}

function stateCell(state) {
  return { text: state, sort: STATES.indexOf(state) };
}

// Those that did it or head for it; else, paler, those that the plan has do it, or that will have done it.
function whoCell(/** @type {Moment} */ moment, task) {
  const { history, scene, plan, mission, step } = moment;
  const isDone = history.doneAt[task] <= step;
  if (!isDone && isOver(history, task, step)) return NOTHING;
  const there = (scene.assignedTo.get(task) ?? []).flatMap(({ robots }) => robots);
  const served = serviceAfter(history, task, step)?.robots ?? [];
  const now = isDone ? history.doers[task] : [...new Set([...served, ...there])];
  if (now.length) return robotsCell(mission, now);
  const planned = plan?.get(task) ?? history.doers[task];
  const later = planned.filter((robot) => !isLost(history, robot, step));
  return later.length ? robotsCell(mission, later, true) : NOTHING;
}

// When a task is done: {at, isAhead}; null if nobody knows. A mission under way is played ahead by
// the server, which says when each task would be done if nothing more happens.
function endOfTask(/** @type {Moment} */ { history, step }, task) {
  if (history.doneAt[task] < Infinity) return { at: history.doneAt[task], isAhead: history.doneAt[task] > step };
  const at = history.expected?.[task] ?? null;
  return at === null ? null : { at, isAhead: true };
}

function endCell(/** @type {Moment} */ moment, task) {
  const end = endOfTask(moment, task);
  return end ? { text: shortMoment(moment.mission.world, end.at), sort: end.at, isAhead: end.isAhead } : NOTHING;
}

// By how much it is late, or will be; of one whose end nobody knows, by how much it is late already.
function lateCell(/** @type {Moment} */ moment, task) {
  const end = endOfTask(moment, task);
  if (!end && isOver(moment.history, task, moment.step)) return NOTHING;
  const late = (end?.at ?? moment.step) - moment.mission.tasks[task].due;
  if (!(late > 0)) return NOTHING;
  return { text: describeSpan(moment.mission.world, late), sort: late, isAhead: !end || end.isAhead, isBad: true };
}

// What a robot's team does, in few words.
function doingOf(/** @type {Moment} */ { scene, mission }, robot) {
  const team = teamOfRobot(scene, robot);
  if (!team) return "lost";
  const task = team.goal === NOBODY ? "" : taskName(mission, team.goal);
  const words = { serves: `does ${task}`, done: `has just done ${task}`, told: "is told next", leaves: "is lost next", idle: "idle", charges: "charges", forms: `forms a team for ${task}`, "leads home": "walks to where it stops", queues: "waits for a charger", off: "off its shift", waits: `waits at ${task}` };
  return words[team.activity] ?? `walks to ${task}`;
}

// By robot, the task that it goes on to after the one that it is about: as the plan has it, else as
// the record goes on. Map robot -> task.
function nextTasks(/** @type {Moment} */ { history, plan, scene, step, deeds }) {
  const next = new Map();
  const isCurrent = (robot, task) => teamOfRobot(scene, robot)?.goal === task;
  for (const [task, robots] of plan ?? []) {
    if (isOver(history, task, step)) continue;
    for (const robot of robots) if (!next.has(robot) && !isCurrent(robot, task)) next.set(robot, task);
  }
  if (plan) return next;
  deeds.forEach((row, robot) => {
    const deed = row.find(({ task, step: at }) => at > step && !isCurrent(robot, task));
    if (deed) next.set(robot, deed.task);
  });
  return next;
}

function nextCell(/** @type {Moment} */ { next, mission, scene }, robot) {
  if (!next.has(robot) || !teamOfRobot(scene, robot)) return NOTHING;
  return word(taskName(mission, next.get(robot)), true);
}

function idleCell(/** @type {Moment} */ { history, step }, robot) {
  if (!step) return NOTHING;
  const share = Number(stepsInPhases(history, robot, step).get(IDLE)) / step;
  return { text: percent(share), sort: share };
}
