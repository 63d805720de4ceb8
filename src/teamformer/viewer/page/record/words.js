// Everything that the page says about robots, teams and tasks, as plain text.

import { absenceAt, needsAt, sitesAt } from "./history.js";
import { describeMoment, describePlace, describeSpan, describeWay, percent, plural, secondsOf } from "./lengths.js";
import { isFlying, walkingDistance } from "./mission.js";
import { isSamePlace } from "./plane.js";
import { isOver, standingOf } from "./scene.js";
import { NOBODY } from "./state.js";
import { chargeAt, serviceAfter, stepsInPhases } from "./told.js";

export const MANY = 3; // names written out
const MANY_NEEDS = 12; // kinds of needs written out

export function robotName(/** @type {Mission} */ mission, robot) {
  return mission.robots[robot].name;
}

export function taskName(/** @type {Mission} */ mission, task) {
  return mission.tasks[task].name;
}

// A lone robot goes by its own name, a team by that of its lowest robot.
function nameOfRobots(/** @type {Mission} */ mission, robots) {
  const name = robots.length ? robotName(mission, Math.min(...robots)) : "nobody";
  return robots.length > 1 ? `team ${name}` : name;
}

export function nameOfTeam(/** @type {Mission} */ mission, /** @type {Team} */ { robots }) {
  return nameOfRobots(mission, robots);
}

// A few names are written out; of more than `most`, the first stands for all.
export function listRobots(/** @type {Mission} */ mission, robots, most = MANY) {
  const shown = robots.length <= most ? robots : robots.slice(0, 1);
  const names = shown.map((robot) => robotName(mission, robot)).join(", ");
  return shown.length < robots.length ? `${names} + ${robots.length - 1} more` : names;
}

export function describeCounts(/** @type {Mission} */ mission, /** @type {Iterable<Count>} */ counts, shown = Infinity) {
  const pairs = [...counts];
  const texts = pairs.slice(0, shown).map(([cap, count]) => {
    const name = mission.capabilities[cap];
    return count === 1 ? name : `${count} x ${name}`;
  });
  if (pairs.length > shown) texts.push(`${pairs.length - shown} more`);
  return texts.join(", ");
}

// How far a team has to go to where its task is believed to be.
export function distanceTo(/** @type {Mission} */ mission, /** @type {Team} */ team) {
  return team.site ? walkingDistance(mission.world, [team.x, team.y], team.site.at, isFlying(mission, team)) : 0;
}

export function describeDoing(/** @type {TrialHistory} */ history, /** @type {Team} */ team, step) {
  const { mission } = history;
  const name = team.goal === NOBODY ? "" : taskName(mission, team.goal);
  const lack = describeCounts(mission, team.missing, MANY);
  const there = team.ahead ? `there ${describeAt(mission.world, team.ahead.until)}` : "";
  switch (team.activity) {
    case "serves": {
      const made = step - (team.service?.from ?? step);
      if (mission.tasks[team.goal].to) return describeLoading(mission, team, name, there);
      return `does ${name}, ${describePart(mission.world, made, mission.tasks[team.goal])}`;
    }
    case "done":
      return `has just done ${name}`;
    case "told":
      return step === 0 ? "is ready to begin" : "is told its next task with the next step";
    case "leaves":
      return "is lost with the next step";
    case "idle":
      return "has no assignment";
    case "charges":
      return "charges until it is full";
    case "queues":
      return "waits for room at a charger";
    case "off":
      return "is off its shift";
    case "forms":
      return `forms a team for ${name}`;
    case "leads home":
      return `walks to where it stops, ${there}`;
    case "waits":
      if (!team.isMet) return `waits at ${name} for ${lack}`;
      return [`is at ${name} with all it needs`, whyClosed(history, team.goal, step)].filter(Boolean).join("; that ");
    default: {
      const way = there || `${describeWay(mission.world, distanceTo(mission, team))} to go`;
      const goes = isFlying(mission, team) ? "flies" : "walks";
      return team.isMet ? `${goes} to ${name} with all it needs, ${way}` : `${goes} to ${name}, ${way}; lacks ${lack}`;
    }
  }
}

// Why a known task may not begin in the next step; nothing if it may.
function whyClosed(/** @type {TrialHistory} */ history, task, step) {
  const { mission } = history;
  const { after, opens } = mission.tasks[task];
  const before = after.filter((other) => !isOver(history, other, step));
  if (before.length) return `comes after ${before.map((other) => taskName(mission, other)).join(", ")}`;
  return opens > step ? `may begin after ${describeMoment(mission.world, opens)}` : "";
}

// What a team does with its load.
function describeLoading(/** @type {Mission} */ { world, tasks }, /** @type {Team} */ team, name, there) {
  if (!team.carries) return `takes up ${name}`;
  const { to } = tasks[team.goal];
  const place = describePlace(world, to);
  if (isSamePlace(world, [team.x, team.y], to)) return `unloads ${name} at ${place}`;
  const way = there || `${describeWay(world, walkingDistance(world, [team.x, team.y], to))} to go`;
  return `carries ${name} to ${place}, ${way}`;
}

// How much of a service is made.
function describePart(/** @type {World} */ world, made, task) {
  const count = world.isTimed ? secondsOf(world, made) : made;
  return `${count} of ${describeDuration(world, task)} made`;
}

// How long a task takes, as far as it is known before it is done.
export function describeDuration(/** @type {World} */ world, /** @type {Task} */ { duration, lasts }) {
  if (!lasts) return describeSpan(world, duration);
  const least = world.isTimed ? secondsOf(world, lasts[0]) : lasts[0];
  return `${least} to ${describeSpan(world, lasts[1])}`;
}

// What a task needs, and what it may need while nobody knows.
export function describeNeeds(/** @type {TrialHistory} */ history, task, step, most = MANY_NEEDS) {
  const { mission, shownAt } = history;
  if (shownAt[task] <= step) return describeCounts(mission, needsAt(history, task, step), most);
  const { sure, mayNeed } = mission.tasks[task];
  return `${describeCounts(mission, sure, most)}, may need ${describeChances(mission, mayNeed)}`;
}

export function describeChances(/** @type {Mission} */ mission, mayNeed) {
  return mayNeed.map(([cap, chance]) => `${mission.capabilities[cap]} (${percent(chance)})`).join(", ");
}

export function describeAt(/** @type {World} */ world, step) {
  return `at ${describeMoment(world, step)}`;
}

export function describeWhen(/** @type {World} */ world, step) {
  return `${world.isTimed ? "at" : "in"} ${describeMoment(world, step)}`;
}

// How a robot has spent its time so far, the largest share first.
export function describeShares(/** @type {TrialHistory} */ history, robot, step) {
  const parts = [...stepsInPhases(history, robot, step)].filter(([, count]) => count).sort(([, a], [, b]) => b - a);
  return parts.map(([name, count]) => `${name} ${percent(count / step)}`).join(", ") || "not yet begun";
}

// Since when a robot is lost.
export function describeLoss(/** @type {TrialHistory} */ history, robot, step) {
  const absence = absenceAt(history, robot, step);
  if (!absence) return "lost";
  return `${isDry(history, robot, absence.from) ? "dry" : "lost"} ${describeWhen(history.mission.world, absence.from)}`;
}

// Whether a robot that is lost since a step has nothing left in its battery.
function isDry(/** @type {TrialHistory} */ history, robot, step) {
  const charge = chargeAt(history, robot, step);
  return charge !== null && charge < EMPTY;
}

const EMPTY = 1e-4; // of a full battery: what is told is rounded

function describeLateness(/** @type {TrialHistory} */ { mission, doneAt }, task) {
  const late = doneAt[task] - mission.tasks[task].due;
  return late > 0 ? `, late by ${describeSpan(mission.world, late)}` : "";
}

export function describeStanding(/** @type {TrialHistory} */ history, task, /** @type {Scene} */ scene) {
  const { mission } = history;
  const { step } = scene;
  const { appears, cancelled } = mission.tasks[task];
  const standing = standingOf(history, task, step);
  const goesOn = step < history.last || history.end.status === "running";
  if (goesOn && cancelled === step + 1 && standing !== "done") return "called off with the next step";
  switch (standing) {
    case "hidden":
      return `appears after ${describeMoment(mission.world, appears)}`;
    case "done":
      if (!history.doers[task].length) return `done by ${describeMoment(mission.world, history.doneAt[task])}, not known by whom`;
      return `done ${describeWhen(mission.world, history.doneAt[task])}${describeLateness(history, task)}`;
    case "cancelled":
      if (history.missed.has(task)) return `missed: ${history.missed.get(task)}`;
      return `called off ${describeWhen(mission.world, cancelled)}`;
    case "served": {
      if (sitesAt(history, step)[task].isUp) return "being carried";
      if (mission.tasks[task].to) return "being taken up";
      const made = step - (serviceAfter(history, task, step)?.from ?? step);
      return `under way, ${describePart(mission.world, made, mission.tasks[task])}`;
    }
    case "blocked":
      return "can never be done";
    default: {
      const assigned = scene.assignedTo.get(task)?.length ?? 0;
      const when = whyClosed(history, task, step) || "open";
      if (assigned) return `${when}, ${plural(assigned, "team")} assigned`;
      const isToBeTold = [...scene.teams.values()].some(({ activity }) => activity === "told");
      return `${when}, ${isToBeTold ? "teams are told next" : "nobody assigned"}`;
    }
  }
}

// Written once for each event.
export function describeEvent(/** @type {TrialHistory} */ history, /** @type {HistoryEvent} */ event) {
  event.text ??= eventText(history, event);
  return event.text;
}

function eventText(/** @type {TrialHistory} */ history, /** @type {HistoryEvent} */ event) {
  const { mission } = history;
  const task = event.task === undefined ? "" : taskName(mission, event.task);
  const team = event.robots?.length ? nameOfRobots(mission, event.robots) : "";
  switch (event.kind) {
    case "join":
      return describeJoin(mission, event);
    case "split":
      return describeSplit(mission, event);
    case "lost":
    case "empty": {
      const name = robotName(mission, event.robots[0]);
      return event.kind === "empty" || isDry(history, event.robots[0], event.step) ? `${name} has run dry` : `${name} is lost`;
    }
    case "charges":
      return `${robotName(mission, event.robots[0])} charges`;
    case "queues":
      return task ? `${team} wait${event.robots.length > 1 ? "" : "s"} for room to unload ${task}` : `${team} waits for a charger`;
    case "full":
      return `${robotName(mission, event.robots[0])} is full`;
    case "back":
      return `${robotName(mission, event.robots[0])} is back`;
    case "appears":
      return `${task} appears`;
    case "cancelled":
      return `${task} is called off`;
    case "missed":
      return `${task} is missed: ${event.why}`;
    case "shown":
      return `${task} needs ${describeCounts(mission, mission.tasks[event.task].needs)}, as it turns out`;
    case "found":
      return `${task} found at ${describePlace(mission.world, mission.tasks[event.task].at)}`;
    case "heads":
      return `${team} heads for ${task}`;
    case "forms":
      return `${listRobots(mission, event.robots)} form a team for ${task}`;
    case "broken":
      return `the service of ${task} breaks off`;
    case "begins":
      return `${team} begins ${task}`;
    case "taken":
      return `${team} has taken up ${task}`;
    case "left":
      return `${task} is set down at ${describePlace(mission.world, event.at)}`;
    case "done":
      return team ? `${task} done by ${team}` : `${task} done by then, not known by whom`;
    default:
      return describeEnd(history);
  }
}

function describeJoin(/** @type {Mission} */ mission, /** @type {HistoryEvent} */ { joiner, partner, robots }) {
  const text = `${nameOfRobots(mission, joiner)} joins ${nameOfRobots(mission, partner)}`;
  return robots.length > 2 ? `${text}, now ${robots.length}` : text;
}

function describeSplit(/** @type {Mission} */ mission, /** @type {HistoryEvent} */ { stay, leave, robots }) {
  return `${nameOfRobots(mission, robots)} splits: ${listRobots(mission, stay)} | ${listRobots(mission, leave)}`;
}

function describeEnd(/** @type {TrialHistory} */ { end, mission }) {
  const blocked = end.blocked_tasks.join(", ");
  const { world } = mission;
  const makespan = world.isTimed ? describeMoment(world, end.makespan) : end.makespan;
  return {
    completed: `completed, makespan ${makespan}`,
    "step limit": "stopped at the step limit",
    "too late": "stopped: a task that must be done was missed",
    infeasible: `stopped: ${blocked} can never be done`,
    interrupted: "interrupted",
  }[end.status];
}
