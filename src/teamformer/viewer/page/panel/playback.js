// What the buttons, the slider and the counter show of the moment.

import { describeMoment } from "../record/lengths.js";
import { allIn, byId, element } from "./dom.js";

export function showPlayback(/** @type {App} */ app) {
  const { player, history } = app;
  const { world } = history.mission;
  byId("counter").replaceChildren(
    "Step ",
    element("b", {}, String(player.step)),
    ` of ${player.last}`,
    world.isPlane ? element("small", {}, ` ${describeMoment(world, player.step)}`) : "",
  );
  byId("scrub").value = String(player.step);
  byId("scrub").setAttribute("aria-valuetext", `step ${player.step} of ${player.last}`);
  showSpeed(player.speed);
  byId("play").classList.toggle("on", player.isPlaying);
  byId("play").setAttribute("aria-label", player.isPlaying ? "Pause" : "Play");
  showStart(app);
}

// A speed that is none of those offered was chosen on the command line: it is offered, too.
function showSpeed(speed) {
  const select = byId("speed");
  const isOffered = [...select.options].some(({ value }) => Number(value) === speed);
  if (!isOffered) select.append(speedOption(speed));
  select.value = String(speed);
}

export function speedOption(speed) {
  return element("option", { value: speed }, `${speed} steps/s`);
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
