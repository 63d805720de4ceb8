// Buttons, keys and pointers.

import { describeGroup } from "../draw/groups.js";
import { RINGS } from "../draw/palette.js";
import { teamOfRobot } from "../record/scene.js";
import { describeCounts, describeDoing, describeLoss, describeNeeds, describeStanding, nameOfTeam, robotName, taskName } from "../record/words.js";
import { BARS } from "../views/bars.js";
import { byId, element, targetOf } from "./dom.js";
import { notify } from "./notice.js";
import { SWITCHES, VIEWS } from "./playback.js";

export function connectControls(/** @type {App} */ app) {
  const { player, map } = app;
  const click = (id, act) => byId(id).addEventListener("click", act);
  click("play", () => player.toggle());
  click("step-back", () => player.stepBy(-1));
  click("step-on", () => player.stepBy(1));
  click("event-back", () => app.goToNextEvent(-1));
  click("event-on", () => app.goToNextEvent(1));
  click("zoom-in", () => app.zoom(1.4));
  click("zoom-out", () => app.zoom(1 / 1.4));
  click("zoom-fit", () => app.fitView());
  click("help", () => byId("help-text").showModal());
  click("start", () => player.toggle());
  click("notice-close", () => notify(""));
  click("more", ({ currentTarget }) => showMore(currentTarget));
  for (const name of SWITCHES) click(name, () => app.toggle(name));
  for (const view of VIEWS) click(`view-${view}`, () => app.look(view));
  connectChoice(app, "rings", RINGS);
  connectChoice(app, "bars", BARS);
  byId("scrub").addEventListener("input", () => app.go(Number(byId("scrub").value)));
  connectSpeed(player);
  document.addEventListener("click", leaveButton);
  document.addEventListener("click", (event) => {
    if (!byId("menu").contains(targetOf(event))) byId("menu").open = false;
  });
  document.addEventListener("keydown", (event) => pressKey(app, event));
  connectPointer(app, map.canvas);
}

// On phones, what the map shows is chosen in rows that unfold.
function showMore(button) {
  const isOpen = byId("tools").classList.toggle("unfolded");
  button.setAttribute("aria-expanded", String(isOpen));
}

// A list of choices for an option of that name.
function connectChoice(/** @type {App} */ app, name, choices) {
  const options = Object.entries(choices).map(([value, text]) => element("option", { value }, text));
  byId(name).append(...options);
  byId(name).addEventListener("change", (event) => {
    app.options[name] = targetOf(event).value;
    app.show(true);
  });
}

// After a click with the mouse the space bar is for playing, not for the button once more.
function leaveButton(/** @type {MouseEvent} */ event) {
  if (event.detail > 0) targetOf(event).closest("button")?.blur();
}

function connectSpeed(/** @type {Player} */ player) {
  byId("speed").addEventListener("change", () => player.goAt(Number(byId("speed").value)));
}

/** @type {Record<string, (app: App) => void>} */
const KEYS = {
  " ": (app) => app.player.toggle(),
  ArrowLeft: (app) => app.player.stepBy(-1),
  ArrowRight: (app) => app.player.stepBy(1),
  Home: (app) => app.go(0),
  End: (app) => app.go(app.history.last),
  "[": (app) => app.goToNextEvent(-1),
  "]": (app) => app.goToNextEvent(1),
  "+": (app) => app.player.faster(1),
  "=": (app) => app.player.faster(1),
  "-": (app) => app.player.faster(-1),
  f: (app) => app.fitView(),
  Escape: (app) => app.select({}),
  g: (app) => lookOrBack(app, "gantt"),
  t: (app) => lookOrBack(app, "tasks"),
  r: (app) => lookOrBack(app, "robots"),
  p: (app) => lookOrBack(app, "plots"),
  "?": () => toggleHelp(),
};

function lookOrBack(/** @type {App} */ app, view) {
  app.look(app.view === view ? "map" : view);
}

function toggleHelp() {
  const help = byId("help-text");
  if (help.open) help.close();
  else help.showModal();
}

// Keys that the focused control uses itself are left to it.
function pressKey(/** @type {App} */ app, /** @type {KeyboardEvent} */ event) {
  const at = targetOf(event);
  if (byId("help-text").open && event.key === "?") return toggleHelp();
  if (byId("menu").open && event.key === "Escape") return (byId("menu").open = false);
  const isTyping = at.matches("input:not([type=range]), textarea, select") || document.querySelector("dialog[open]");
  const isPressing = event.key === " " && at.closest("button, summary");
  if (isTyping || isPressing || event.ctrlKey || event.metaKey || event.altKey) return;
  const act = KEYS[event.key.length === 1 ? event.key.toLowerCase() : event.key];
  if (!act) return;
  event.preventDefault();
  act(app);
}

// One pointer drags or selects, two pinch.
function connectPointer(/** @type {App} */ app, /** @type {HTMLCanvasElement} */ canvas) {
  /** @type {Map<number, Place>} */ const pointers = new Map();
  let moved = 0;
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, [event.offsetX, event.offsetY]);
    if (pointers.size > 1) return;
    moved = 0;
    app.hold(app.map.thingAt(event.offsetX, event.offsetY), placeUnder(app, event));
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!pointers.has(event.pointerId)) return showTip(app, event);
    const before = pointers.get(event.pointerId) ?? [0, 0];
    /** @type {Place} */ const after = [event.offsetX, event.offsetY];
    moved += Math.abs(after[0] - before[0]) + Math.abs(after[1] - before[1]);
    if (moved > 4 && !app.drag(placeUnder(app, event))) dragMap(app.map, pointers, event.pointerId, before, after);
    pointers.set(event.pointerId, after);
  });
  canvas.addEventListener("pointerup", (event) => {
    pointers.delete(event.pointerId);
    canvas.classList.remove("dragged");
    if (app.drop()) return;
    if (moved <= 4) clickMap(app, event);
  });
  canvas.addEventListener("pointercancel", (event) => pointers.delete(event.pointerId));
  canvas.addEventListener("pointerleave", () => (byId("tip").hidden = true));
  connectWheel(app.map);
}

// Of a group of robots, a click shows more; of all else, what it is.
function clickMap(/** @type {Shown} */ app, /** @type {{ offsetX: number, offsetY: number }} */ { offsetX, offsetY }) {
  const thing = app.map.thingAt(offsetX, offsetY);
  if (thing.group) app.map.zoom(2.2, thing.group.x, thing.group.y);
  else app.pick(thing, placeUnder(app, { offsetX, offsetY }));
}

function placeUnder(/** @type {Shown} */ app, /** @type {{ offsetX: number, offsetY: number }} */ { offsetX, offsetY }) {
  return app.map.shown.camera.placeAt(offsetX, offsetY);
}

function connectWheel(/** @type {TrialMap} */ map) {
  const turn = (event) => {
    event.preventDefault();
    const factor = Math.exp(-event.deltaY * (event.ctrlKey ? 0.01 : 0.0016));
    map.zoom(factor, event.offsetX, event.offsetY);
  };
  map.canvas.addEventListener("wheel", turn, { passive: false });
}

// The map of a companion: it is dragged and zoomed, and what is clicked is selected in all records.
export function connectCompanion(/** @type {Companion} */ companion) {
  const { map } = companion;
  let moved = 0;
  connectWheel(map);
  map.canvas.addEventListener("pointerdown", () => (moved = 0));
  map.canvas.addEventListener("pointermove", ({ buttons, movementX, movementY }) => {
    moved += Math.abs(movementX) + Math.abs(movementY);
    if (buttons && moved > 4) map.pan(movementX, movementY);
  });
  map.canvas.addEventListener("pointerup", (event) => moved <= 4 && clickMap(companion, event));
}

function dragMap(/** @type {TrialMap} */ map, /** @type {Map<number, Place>} */ pointers, id, before, after) {
  byId("tip").hidden = true;
  map.canvas.classList.add("dragged");
  if (pointers.size === 1) {
    map.pan(after[0] - before[0], after[1] - before[1]);
    return;
  }
  const other = [...pointers].find(([key]) => key !== id)?.[1] ?? after;
  const apart = ([x, y]) => Math.hypot(x - other[0], y - other[1]);
  map.zoom(apart(after) / Math.max(1, apart(before)), (after[0] + other[0]) / 2, (after[1] + other[1]) / 2);
}

function showTip(/** @type {App} */ app, /** @type {PointerEvent} */ { offsetX, offsetY, pointerType }) {
  const tip = byId("tip");
  const thing = app.map.thingAt(offsetX, offsetY);
  const lines = pointerType === "mouse" ? tipLines(app, thing) : null;
  app.map.canvas.classList.toggle("over", Boolean(lines));
  tip.hidden = !lines;
  if (!lines) return;
  tip.replaceChildren(element("strong", {}, lines[0]), lines[1]);
  const left = Math.min(offsetX + 14, app.map.width - tip.offsetWidth - 8);
  const top = Math.min(offsetY + 16, app.map.height - tip.offsetHeight - 8);
  tip.style.left = `${Math.max(4, left)}px`;
  tip.style.top = `${Math.max(4, top)}px`;
}

function tipLines(/** @type {Shown} */ app, /** @type {Thing} */ { robot, task, group }) {
  const { history } = app;
  if (group) return describeGroup(group);
  const { mission } = history;
  if (task !== undefined) {
    const needs = describeNeeds(history, task, app.player.step);
    return [taskName(mission, task), `${describeStanding(history, task, app.scene())}; needs ${needs}`];
  }
  if (robot === undefined) return null;
  const team = teamOfRobot(app.scene(), robot);
  const can = describeCounts(mission, mission.robots[robot].can, 5);
  const title = `${robotName(mission, robot)} (${can})`;
  if (!team) return [title, describeLoss(history, robot, app.player.step)];
  const who = team.robots.length > 1 ? `in ${nameOfTeam(mission, team)}, which ` : "";
  return [title, who + describeDoing(history, team, app.player.step)];
}
