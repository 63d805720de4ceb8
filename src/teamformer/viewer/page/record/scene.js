// What there is to see after a step: teams with what they can do, and how each task stands.

import { wayAhead } from "./continuous.js";
import { addCounts, missing } from "./counts.js";
import { isLost, needsAt, sitesAt, stateShown } from "./history.js";
import { isSamePlace } from "./plane.js";
import { NOBODY } from "./state.js";
import { CHARGING, FORMING, IDLE, LOST, OFF, QUEUEING, WAITING, WALKING, runAfter, serviceAfter } from "./told.js";

const NEWS = ["appears", "cancelled", "lost", "back", "found", "shown"];

// A team: {slot, robots, x, y, counts, assigned, goal, isMet, missing, service, justDone, activity,
// carries}.
// `site` is where its task is believed to be, `goal` is the task whose colour the ring may take: the one served, just done or headed for.
export function sceneAt(/** @type {TrialHistory} */ history, step) {
  const state = stateShown(history, step);
  const teams = gatherTeams(history.mission, state);
  const serving = servicesAt(history, state, step);
  const justDone = doneIn(history, state, step);
  const sites = sitesAt(history, step);
  for (const team of teams.values()) {
    describeGoal(history, step, team, serving.get(team.slot), justDone.get(team.slot));
    team.site = sites[team.assigned] ?? null;
    team.carries = team.service !== null && sites[team.service.task].isUp === true;
    team.ahead = history.isContinuous ? wayAhead(history, team.slot, step) : null;
    team.activity = activityOf(history.mission.world, team);
    if (history.isContinuous) team.activity = activityToldOf(history, team, step);
    else if (team.activity === "idle") team.activity = whatComes(history, team, step);
  }
  const assigned = [...teams.values()].filter((team) => team.assigned !== NOBODY);
  return { step, state, teams, assignedTo: Map.groupBy(assigned, (team) => team.assigned) };
}

/** @returns {Map<number, Team>} */
function gatherTeams(/** @type {Mission} */ mission, /** @type {State} */ state) {
  const teams = new Map();
  for (let robot = 0; robot < state.team.length; robot++) {
    const slot = state.team[robot];
    if (slot === NOBODY) continue;
    if (!teams.has(slot)) teams.set(slot, newTeam(state, slot));
    teams.get(slot).robots.push(robot);
  }
  for (const team of teams.values()) team.counts = addCounts(team.robots.map((robot) => mission.robots[robot].can));
  return teams;
}

function newTeam(/** @type {State} */ state, slot) {
  const assigned = state.task[slot];
  return { slot, robots: [], x: state.x[slot], y: state.y[slot], assigned };
}

function describeGoal(/** @type {TrialHistory} */ history, step, /** @type {Team} */ team, service, done) {
  team.service = service ?? null;
  team.justDone = done ?? NOBODY;
  team.goal = service?.task ?? done ?? team.assigned;
  team.missing = team.goal === NOBODY ? [] : missing(team.counts, needsAt(history, team.goal, step));
  team.isMet = team.goal !== NOBODY && team.missing.length === 0;
}

// Some teams have no assignment only until the next step: "told" what they are about then, or lost, as
// it is told; where a mission goes on that nobody has told yet, after the start and after news.
function whatComes(/** @type {TrialHistory} */ history, /** @type {Team} */ { robots }, step) {
  if (step < history.last) {
    const phases = robots.map((robot) => runAfter(history, robot, step)?.phase ?? IDLE);
    if (phases.every((phase) => phase === LOST)) return "leaves";
    return phases.some((phase) => phase !== IDLE && phase !== LOST) ? "told" : "idle";
  }
  return history.end.status === "running" && (step === 0 || newsIn(history, step).length) ? "told" : "idle";
}

// What happened in a step that has it planned anew.
export function newsIn(/** @type {TrialHistory} */ { events }, step) {
  return events.filter((event) => event.step === step && NEWS.includes(event.kind));
}

// What a team is about, in one word: serves, done, waits, walks or idle; told and leaves, see `whatComes`;
// and in continuous time forms, off outside its shifts, and leads home for one that walks to where it stops.
function activityOf(/** @type {World} */ world, /** @type {Team} */ team) {
  if (team.service) return "serves";
  if (team.justDone !== NOBODY) return "done";
  if (team.assigned === NOBODY) return "idle";
  return team.site && isSamePlace(world, [team.x, team.y], team.site.at) ? "waits" : "walks";
}

// The same in continuous time, where it is told of every robot what it does.
function activityToldOf(/** @type {TrialHistory} */ history, /** @type {Team} */ team, step) {
  const { phase, task } = runAfter(history, team.slot, step) ?? { phase: IDLE, task: NOBODY };
  if (phase === WALKING) return task === NOBODY ? "leads home" : "walks";
  if (phase === FORMING) return "forms";
  if (phase === WAITING) return "waits";
  if (phase === OFF) return "off";
  if (phase === CHARGING) return "charges";
  if (phase === QUEUEING) return "queues";
  return phase === IDLE ? (team.justDone === NOBODY ? "idle" : "done") : "serves";
}

/** @returns {Map<number, Service>} */
function servicesAt(/** @type {TrialHistory} */ history, /** @type {State} */ { team }, step) {
  const services = history.mission.tasks.flatMap((_, task) => serviceAfter(history, task, step) ?? []);
  return new Map(services.flatMap((service) => service.robots.map((robot) => [team[robot], service])));
}

// By slot, the first task that a team has done in a step; who did it may be lost in the same step.
function doneIn(/** @type {TrialHistory} */ history, /** @type {State} */ { team }, step) {
  const done = new Map();
  history.doneAt.forEach((at, task) => {
    const robot = history.doers[task].find((doer) => team[doer] !== NOBODY);
    if (Math.ceil(at) === step && robot !== undefined && !done.has(team[robot])) done.set(team[robot], task);
  });
  return done;
}

export function teamOfRobot(/** @type {Scene} */ scene, /** @type {number | undefined} */ robot) {
  return robot === undefined ? null : (scene.teams.get(scene.state.team[robot]) ?? null);
}

// How a task stands after a step: hidden, open, served, done, cancelled or (at the end) blocked.
export function standingOf(/** @type {TrialHistory} */ history, task, step) {
  if (isOver(history, task, step)) return history.doneAt[task] <= step ? "done" : "cancelled";
  if (history.mission.tasks[task].appears > step) return "hidden";
  if (serviceAfter(history, task, step)) return "served";
  const isBlocked = step === history.last && history.end.blocked_tasks.includes(history.mission.tasks[task].name);
  return isBlocked ? "blocked" : "open";
}

// Whether a task is done, called off or missed.
export function isOver(/** @type {TrialHistory} */ { overAt }, task, step) {
  return overAt[task] <= step;
}

export function countDone(/** @type {TrialHistory} */ history, step) {
  return history.doneAt.filter((at) => at <= step).length;
}

export function countCancelled(/** @type {TrialHistory} */ history, step) {
  return history.overAt.filter((at) => at <= step).length - countDone(history, step);
}

// The open tasks in the order that everybody shares, as last computed.
export function orderAt(/** @type {TrialHistory} */ history, step) {
  const [, tasks] = (history.record.orders ?? []).findLast(([made]) => made <= step) ?? [0, []];
  return tasks.filter((task) => !isOver(history, task, step));
}

function namesCap(/** @type {Counts} */ counts, cap) {
  return counts.some(([other]) => other === cap);
}

// The robots that bring a capability and are not lost.
export function robotsWith(/** @type {TrialHistory} */ history, cap, step) {
  const { robots } = history.mission;
  const all = robots.map((_, robot) => robot);
  return all.filter((robot) => !isLost(history, robot, step) && namesCap(robots[robot].can, cap));
}

// The tasks that are known, not over and need a capability.
export function tasksNeeding(/** @type {TrialHistory} */ history, cap, step) {
  const { mission } = history;
  const all = mission.tasks.map((_, task) => task);
  return all.filter((task) => {
    const { appears } = mission.tasks[task];
    return appears <= step && !isOver(history, task, step) && namesCap(needsAt(history, task, step), cap);
  });
}
