// What the buttons, the slider and the counter show of the moment.

import { describeMoment } from "../record/lengths.js";
import { allIn, byId, element } from "./dom.js";

export function showPlayback(/** @type {App} */ app) {
  const { player, history } = app;
  byId("counter").replaceChildren(...(history.isContinuous ? timeOf(app) : stepOf(app)));
  byId("scrub").value = String(player.step);
  byId("scrub").setAttribute("aria-valuetext", describeNow(app));
  showSpeed(player);
  byId("play").classList.toggle("on", player.isPlaying);
  byId("play").setAttribute("aria-label", player.isPlaying ? "Pause" : "Play");
  showStart(app);
}

function stepOf(/** @type {App} */ { player, history }) {
  const { world } = history.mission;
  const seconds = world.isTimed ? element("small", {}, ` ${describeMoment(world, player.step)}`) : "";
  return ["Step ", element("b", {}, String(player.step)), ` of ${player.last}`, seconds];
}

function timeOf(/** @type {App} */ app) {
  const { player } = app;
  return ["Time ", element("b", {}, shownMoment(app, player.step)), ` of ${shownMoment(app, player.last)}`];
}

// A moment in continuous time; a record ends within its last tick.
export function shownMoment(/** @type {App} */ { history }, step) {
  const { last, until = last, mission } = history;
  return describeMoment(mission.world, step === last ? until : step);
}

// The moment that is shown, as it is read out.
export function describeNow(/** @type {App} */ app) {
  const { player, history } = app;
  if (!history.isContinuous) return `step ${player.step} of ${player.last}`;
  return `time ${shownMoment(app, player.step)} of ${shownMoment(app, player.last)}`;
}

// The speeds that the player offers; one that is none of these was chosen on the command line, and is
// offered, too.
function showSpeed(/** @type {Player} */ player) {
  const { speed } = player;
  const select = byId("speed");
  if (!player.speeds.includes(speed)) player.speeds = [...player.speeds, speed];
  const offered = [...select.options].map(({ value }) => Number(value));
  if (player.speeds.join() !== offered.join()) select.replaceChildren(...player.speeds.map((one) => speedOption(player, one)));
  select.value = String(speed);
}

// Steps a second, or in continuous time units of time.
function speedOption(/** @type {Player} */ { tick }, speed) {
  const text = tick === null ? `${speed} steps/s` : `${Number((speed * tick).toPrecision(3))} units/s`;
  return element("option", { value: speed }, text);
}

// Before anything has been played: how to start.
function showStart(/** @type {App} */ app) {
  const text = app.startText();
  byId("start").hidden = !text;
  byId("start-text").textContent = text;
}

export function showSwitches(/** @type {App} */ app) {
  for (const name of SWITCHES) byId(name).setAttribute("aria-pressed", String(app.options[name]));
  byId("messages").hidden = !app.history.hasMessages;
  byId("more").hidden = !["map", "gantt"].includes(app.view);
  byId("zoom").hidden = app.view in app.tables || app.view === "plots";
  byId("save-picture").hidden = app.view in app.tables;
  byId("rings").value = app.options.rings;
  byId("bars").value = app.options.bars;
  for (const view of VIEWS) {
    byId(`view-${view}`).setAttribute("aria-pressed", String(app.view === view));
    byId(`stage-${view}`).hidden = app.view !== view;
    for (const node of allIn(document, `.of-${view}`)) node.hidden = app.view !== view;
  }
}

export const SWITCHES = ["lines", "trails", "order", "messages", "names", "dim"];
export const VIEWS = ["map", "gantt", "tasks", "robots", "plots"];
