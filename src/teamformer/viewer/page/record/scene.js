// What there is to see after a step: teams with what they can do, and how each task stands.

import { exact, missing } from "./counts.js";
import { NEWS, isLost, needsAt, pursuedIn, serviceOf, sitesAt, stateShown } from "./history.js";
import { isSamePlace } from "./plane.js";
import { NOBODY } from "./state.js";

// A team: {slot, robots, x, y, counts, assigned, goal, isMet, missing, service, justDone, activity,
// carries}.
// `site` is where its task is believed to be, `goal` is the task whose colour the ring may take: the one served, just done or headed for.
export function sceneAt(/** @type {TrialHistory} */ history, step) {
  const state = stateShown(history, step);
  const teams = gatherTeams(history.mission, state);
  const serving = servicesAt(history, step);
  const justDone = doneIn(history, step);
  const sites = sitesAt(history, step);
  for (const team of teams.values()) {
    describeGoal(history, step, team, serving.get(team.slot), justDone.get(team.slot));
    team.site = sites[team.assigned] ?? null;
    team.carries = team.service !== null && sites[team.service.task].isUp === true;
    team.activity = activityOf(history.mission.world, team);
  }
  tellWhoAwaitsAPlan(history, step, [...teams.values()]);
  return { step, state, teams, assignedTo: groupByTask(teams) };
}

function gatherTeams(/** @type {Mission} */ mission, /** @type {State} */ state) {
  const teams = new Map();
  for (let robot = 0; robot < state.team.length; robot++) {
    const slot = state.team[robot];
    if (slot === NOBODY) continue;
    if (!teams.has(slot)) teams.set(slot, newTeam(state, slot));
    const team = teams.get(slot);
    team.robots.push(robot);
    for (const [cap, count] of mission.robots[robot].can) {
      team.counts.set(cap, exact((team.counts.get(cap) ?? 0) + count));
    }
  }
  return teams;
}

function newTeam(/** @type {State} */ state, slot) {
  const assigned = state.task[slot];
  return { slot, robots: [], counts: new Map(), x: state.x[slot], y: state.y[slot], assigned };
}

function describeGoal(/** @type {TrialHistory} */ history, step, /** @type {Team} */ team, service, done) {
  team.service = service ?? null;
  team.justDone = done ?? NOBODY;
  team.goal = service?.task ?? done ?? team.assigned;
  team.missing = team.goal === NOBODY ? [] : missing(team.counts, needsAt(history, team.goal, step));
  team.isMet = team.goal !== NOBODY && team.missing.length === 0;
}

// Some teams have no assignment only until the next step: the mission begins, or news has taken all
// assignments back. Where the record goes on, it says which of them are idle all the same, and which
// are lost before they are told anything.
function tellWhoAwaitsAPlan(/** @type {TrialHistory} */ history, step, teams) {
  const idle = teams.filter(({ activity }) => activity === "idle");
  if (!idle.length || !isPlannedAnew(history, step)) return;
  const isOver = step >= history.last;
  if (isOver && history.end.status !== "running") return;
  const isAbout = isOver ? () => true : whoIsAboutATask(history, step + 1);
  const isGone = (robot) => isLost(history, robot, step + 1);
  for (const team of idle) {
    if (team.robots.some(isAbout)) team.activity = "told";
    else if (team.robots.every(isGone)) team.activity = "leaves";
  }
}

// Returns what says of a robot whether it has a task in a step.
function whoIsAboutATask(/** @type {TrialHistory} */ history, step) {
  const after = history.at(step);
  const [pursued, done] = [pursuedIn(history, step), doneIn(history, step)];
  return (robot) => {
    const slot = after.team[robot];
    return slot !== NOBODY && (after.task[slot] !== NOBODY || pursued.has(slot) || done.has(slot));
  };
}

// Whether a plan or an order is made after a step, before anybody goes on.
function isPlannedAnew(/** @type {TrialHistory} */ { record, events }, step) {
  if (step === 0) return true;
  if ([...(record.orders ?? []), ...(record.plans ?? [])].some(([made]) => made === step)) return true;
  return events.some((event) => event.step === step && NEWS.includes(event.kind));
}

// What a team is about, in one word: serves, done, waits, walks or idle; and told and leaves, see `tellWhoAwaitsAPlan`.
function activityOf(/** @type {World} */ world, /** @type {Team} */ team) {
  if (team.service) return "serves";
  if (team.justDone !== NOBODY) return "done";
  if (team.assigned === NOBODY) return "idle";
  return team.site && isSamePlace(world, [team.x, team.y], team.site.at) ? "waits" : "walks";
}

function servicesAt(/** @type {TrialHistory} */ history, step) {
  const serving = new Map();
  const { team } = stateShown(history, step);
  history.services.forEach((_, task) => {
    const { robots, from } = serviceOf(history, task, step) ?? { robots: [] };
    for (const robot of robots) serving.set(team[robot], { task, from });
  });
  return serving;
}

function doneIn(/** @type {TrialHistory} */ history, step) {
  const done = new Map();
  history.doneAt.forEach((at, task) => {
    if (at === step && !done.has(history.doneBy[task])) done.set(history.doneBy[task], task);
  });
  return done;
}

function groupByTask(teams) {
  const groups = new Map();
  for (const team of teams.values()) {
    if (team.assigned === NOBODY) continue;
    if (!groups.has(team.assigned)) groups.set(team.assigned, []);
    groups.get(team.assigned).push(team);
  }
  return groups;
}

export function teamOfRobot(/** @type {Scene} */ scene, /** @type {number | undefined} */ robot) {
  return robot === undefined ? null : (scene.teams.get(scene.state.team[robot]) ?? null);
}

// How a task stands after a step: hidden, open, served, done, cancelled or (at the end) blocked.
export function standingOf(/** @type {TrialHistory} */ history, task, step) {
  if (isOver(history, task, step)) return history.doneAt[task] <= step ? "done" : "cancelled";
  if (history.mission.tasks[task].appears > step) return "hidden";
  if (serviceOf(history, task, step)) return "served";
  if (
    step === history.last &&
    history.end.blocked_tasks.includes(history.mission.tasks[task].name)
  )
    return "blocked";
  return "open";
}

// Whether a task is done or called off.
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
  let tasks = [];
  for (const [made, order] of history.record.orders ?? []) if (made <= step) tasks = order;
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
