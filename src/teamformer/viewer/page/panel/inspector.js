// The part of the side that says what the selected team, task or capability is about.

import { needsAt, sitesAt } from "../record/history.js";
import { capitalised, describePlace, describeSpan, describeWay, percent, plural, shortMoment } from "../record/lengths.js";
import { newsIn, orderAt, robotsWith, standingOf, tasksNeeding } from "../record/scene.js";
import { NOBODY } from "../record/state.js";
import { robotStory, taskStory } from "../record/story.js";
import { describeAt, describeChances, describeDoing, describeDuration, describeEvent, describeLoss, describeShares, describeStanding, robotName } from "../record/words.js";
import { chargeAt, reasonFor } from "../record/told.js";
import { CHIPS_SHOWN, capabilityChips, robotChips, taskChip, taskLink } from "./chips.js";
import { byId, element, foldedList, link, mark, oneStop, refill, swatch, taskMark, teamMark, titled } from "./dom.js";
import { assignedTeams, lackingAt, missingOfBest, waitingFor } from "./waiting.js";

const STORY_SHOWN = 40;

export function showDetails(/** @type {App} */ app) {
  refill(byId("details"), detailsOf(app));
}

function detailsOf(/** @type {App} */ app) {
  const { task, robot, cap } = app.selection;
  if (task !== undefined) return taskDetails(app, task);
  if (cap !== undefined) return capabilityDetails(app, cap);
  if (robot === undefined) return overview(app);
  const team = app.selectedTeam();
  return team ? teamDetails(app, team, robot) : lostDetails(app, robot);
}

export const ACTIVITIES = {
  walks: "on the way",
  waits: "waiting",
  serves: "at work",
  done: "just done",
  told: "about to be told their next task",
  leaves: "lost with the next step",
  forms: "forming a team",
  "leads home": "on the way to where they stop",
  charges: "charging",
  queues: "waiting for a charger",
  idle: "without assignment",
  off: "off its shift",
};

function overview(/** @type {App} */ app) {
  if (app.isUnheard()) return [element("h2", {}, "No robot heard yet"), lead("What the map shows is only where the robots start")];
  const scene = app.scene();
  const counts = new Map();
  const teams = [...scene.teams.values()];
  for (const team of teams) {
    counts.set(team.activity, (counts.get(team.activity) ?? 0) + 1);
  }
  const parts = Object.keys(ACTIVITIES)
    .filter((activity) => counts.has(activity))
    .map((activity) => `${counts.get(activity)} ${scene.step || activity !== "told" ? ACTIVITIES[activity] : "ready to begin"}`);
  const hint =
    "Click a team or a task, on the map or in the lists, to see what it does and waits for.";
  return [
    element("h2", {}, `${plural(teams.length, "team")} ${describeAt(app.history.mission.world, scene.step)}`),
    lead(parts.join(", ") || "No robot is left"),
    element("p", { class: "muted" }, hint),
  ];
}

// What a robot's team is doing; the robot is the one that the page follows.
function teamDetails(/** @type {App} */ app, /** @type {Team} */ team, robot) {
  const { mission } = app.history;
  return [
    heading(app, teamMark(app, team), titleOfTeam(mission, team)),
    lead(capitalised(describeDoing(app.history, team, app.player.step))),
    whyText(app, team),
    ...(app.actionsFor(robot)),
    waitingFor(app, team.goal, team.missing, team),
    delayText(app, robot),
    chargeText(app, robot),
    sharesText(app, robot),
    ...saidOf(FILE_KEYS.robots, mission.robots[robot]),
    ...(team.robots.length > 1 ? titled("Robots", robotChips(app, team.robots, robot)) : []),
    ...titled("Brings", capabilityChips(app, "brings", team.counts)),
    ...(team.goal === NOBODY ? [] : titled("Task", taskLink(app, team.goal))),
    ...titled(
      `History of ${robotName(mission, robot)}`,
      storyList(app, robotStory(app.history, robot)),
    ),
  ];
}

function titleOfTeam(/** @type {Mission} */ mission, /** @type {Team} */ team) {
  const { length } = team.robots;
  if (length === 1) return robotName(mission, team.slot);
  return `Team ${robotName(mission, team.slot)} of ${length} robots`;
}

function whyText(/** @type {App} */ { history, player }, /** @type {Team} */ { activity, slot }) {
  const step = Math.min(player.step, history.last);
  const isLast = step === history.last;
  if (activity === "done" || activity === "leaves" || (isLast && history.end.status !== "running")) return null;
  const isAhead = activity === "told" && isLast; // nobody has told it yet
  const why = isAhead ? newsIn(history, step).map((event) => describeEvent(history, event)).join(", ") : reasonFor(history, slot, step);
  return why ? element("p", { class: "muted", id: "why" }, `Why: ${why}.`) : null;
}

function sharesText(/** @type {App} */ { history, player }, robot) {
  if (!player.step) return null;
  const text = `${robotName(history.mission, robot)} so far: ${describeShares(history, robot, player.step)}`;
  return element("p", { class: "muted" }, text);
}

function chargeText(/** @type {App} */ { history, player }, robot) {
  const charge = chargeAt(history, robot, player.time);
  return charge === null ? null : element("p", { class: "muted", id: "charge" }, `Battery: ${percent(charge)}`);
}

function delayText(/** @type {App} */ { history }, robot) {
  const { delay } = history.mission.robots[robot];
  return delay ? element("p", { class: "muted" }, `Stands still in ${percent(delay)} of the steps`) : null;
}

// What a file says of a robot or a task that is there to be shown, such as a note.
function saidOf(keys, { said }) {
  const shown = keys.filter(({ name, isInDetails }) => isInDetails && said[name] !== undefined);
  return shown.map(({ name, label }) => element("p", { class: "muted" }, `${label}: ${said[name]}`));
}

function lostDetails(/** @type {App} */ app, robot) {
  const { history, player } = app;
  const name = robotName(history.mission, robot);
  return [
    heading(app, mark("mark", app.map.theme.lost), name),
    lead(capitalised(describeLoss(history, robot, player.step))),
    ...(app.actionsFor(robot)),
    ...saidOf(FILE_KEYS.robots, history.mission.robots[robot]),
    ...titled(`History of ${name}`, storyList(app, robotStory(history, robot))),
  ];
}

function taskDetails(/** @type {App} */ app, task) {
  const { history, player } = app;
  const { name, sure, mayNeed, duration } = history.mission.tasks[task];
  const isShown = history.shownAt[task] <= player.step;
  const needs = isShown ? needsAt(history, task, player.step) : sure;
  const standing = standingOf(history, task, player.step);
  const isOpen = standing === "open";
  const what = history.mission.tasks[task].to ? "loading takes" : "takes";
  const steps = duration ? `, ${what} ${durationText(history, task, player.step)}` : "";
  return [
    heading(app, taskMark(app, task), name),
    lead(capitalised(describeStanding(history, task, app.scene()))),
    element("p", { class: "muted" }, `${placeText(history, task, player.step)}${steps}${orderText(app, task)}`),
    ...saidOf(FILE_KEYS.tasks, history.mission.tasks[task]),
    ...titled("Needs", capabilityChips(app, "needs", needs, isOpen ? lackingAt(app, task) : [])),
    ...(isShown ? [] : titled("May need", element("p", {}, describeChances(history.mission, mayNeed)))),
    ...(app.actionsForTask(task)),
    isOpen ? waitingFor(app, task, missingOfBest(app, task), null) : null,
    isOpen || standing === "served" ? assignedTeams(app, task) : null,
    ...titled("History", storyList(app, taskStory(history, task))),
  ];
}

// Where it is, or where it is believed to be while nobody knows.
function placeText(/** @type {TrialHistory} */ history, task, step) {
  const { world, tasks } = history.mission;
  const { around, within } = tasks[task];
  const site = sitesAt(history, step)[task];
  const at = describePlace(world, site.at);
  if (history.foundAt[task] <= step) return loadPlaceText(history, task, at, site.isUp);
  if (world.roads) return `At most ${Number(within.toFixed(3))} from ${describePlace(world, around)}, believed at ${at}`;
  return `Within ${describeWay(world, within)} of ${describePlace(world, around)}, believed at ${at}`;
}

// Where a task is, and where its load goes; one that is carried is where its team is.
function loadPlaceText(/** @type {TrialHistory} */ { mission }, task, at, isUp = false) {
  const { to, unload } = mission.tasks[task];
  if (!to) return `At ${at}`;
  const stay = unload ? `, unloading takes ${describeSpan(mission.world, unload)}` : "";
  const where = isUp ? "On its way" : `At ${at}, to be brought`;
  return `${where} to ${describePlace(mission.world, to)}${stay}`;
}

// Once it is done, how long it really took is known.
function durationText(/** @type {TrialHistory} */ { mission, doneAt }, task, step) {
  const known = mission.tasks[task];
  return doneAt[task] <= step ? describeSpan(mission.world, known.duration) : describeDuration(mission.world, known);
}

function orderText(/** @type {App} */ app, task) {
  const rank = orderAt(app.history, app.player.step).indexOf(task);
  return rank < 0 ? "" : `, number ${rank + 1} in the order`;
}

function capabilityDetails(/** @type {App} */ app, cap) {
  const { history, player } = app;
  const robots = robotsWith(history, cap, player.step);
  const tasks = tasksNeeding(history, cap, player.step);
  const links = tasks.map((task) => taskChip(app, task));
  return [
    heading(app, swatch(app, cap), history.mission.capabilities[cap]),
    lead(capitalised(describeCapability(app, cap))),
    ...(robots.length ? titled("Robots", robotChips(app, robots)) : []),
    ...(tasks.length ? titled("Open tasks", foldedList("open", "chips", links, CHIPS_SHOWN)) : []),
  ];
}

export function describeCapability(/** @type {App} */ { history, player }, cap) {
  const robots = robotsWith(history, cap, player.step).length;
  const tasks = tasksNeeding(history, cap, player.step).length;
  return `${plural(robots, "robot")}, needed by ${plural(tasks, "open task")}`;
}

function heading(/** @type {App} */ app, sign, text) {
  const clear = link("Deselect", () => app.select({}), "clear"); // not Close, which is read as Lose
  clear.title = "Select nothing (Esc)";
  return element("h2", {}, sign, element("span", {}, text), clear);
}

function lead(text) {
  return element("p", { class: "lead" }, text);
}

// What has happened and, paler, what is still ahead.
function storyList(/** @type {App} */ app, events) {
  const { step } = app.player;
  if (!events.length) return element("p", { class: "muted" }, "Nothing yet.");
  const items = events.map((event, number) => {
    const text = describeEvent(app.history, event);
    const go = link(text, () => app.go(event.step), `story ${number}`);
    const { world } = app.history.mission;
    const when = element("span", { class: "when" }, shortMoment(world, event.when ?? event.step));
    return element("li", { class: event.step > step ? "ahead" : "" }, when, go);
  });
  return oneStop(foldedList("story", "story", items, STORY_SHOWN));
}
