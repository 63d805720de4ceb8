// Another record beside the first one: its own map and Gantt view, the same clock and selection.

import { TrialMap } from "../draw/map.js";
import { connectCompanion } from "../panel/controls.js";
import { byId, element } from "../panel/dom.js";
import { describeProgress } from "../panel/header.js";
import { teamOfRobot } from "../record/scene.js";
import { Gantt } from "../views/gantt.js";
import { recordColour, recordItem, titleOf } from "./titles.js";
import { Shown } from "../shown.js";

export class Companion extends Shown {
  constructor(/** @type {App} */ app, /** @type {Trial} */ trial) {
    super(app.player, app.options);
    this.app = app;
    this.parts = this.build();
    byId("stage-map").append(this.parts.box);
    byId("stage-gantt").append(this.parts.phases, this.parts.bars);
    this.map = new TrialMap(this, this.parts.mapCanvas);
    connectCompanion(this);
    this.gantt = new Gantt(this, this.parts.ganttCanvas, this.parts.phases);
    this.showTrial(trial);
  }

  build() {
    const name = element("strong", {});
    const state = element("span", {});
    const dot = element("span", { class: "dot" });
    const close = element("button", { type: "button", class: "link", on: () => this.app.close(this.trial) }, "Close");
    const caption = element("p", { class: "caption" }, dot, name, " ", state, " ", close);
    const mapCanvas = element("canvas", { role: "img" });
    const ganttCanvas = element("canvas", { role: "img", tabindex: 0 });
    return {
      ...{ name, state, dot, mapCanvas, ganttCanvas },
      box: element("div", { class: "map beside" }, mapCanvas, caption),
      phases: element("ul", { class: "phases", "aria-label": "Shares of the fleet's time" }),
      bars: element("div", { class: "bars" }, element("div", { class: "sizer" }, ganttCanvas)),
    };
  }

  // A world as large as the first one's is seen through the same camera: both move together.
  showTrial(/** @type {Trial} */ trial) {
    this.put(trial);
    const { world } = this.history.mission;
    this.map.look(world);
    if (isAsLarge(world, this.app.history.mission.world)) this.map.camera = this.app.map.camera;
    this.gantt.forget();
  }

  close() {
    for (const part of ["box", "phases", "bars"]) this.parts[part].remove();
  }

  get selection() {
    return sameByName(this.app.history.mission, this.history.mission, this.app.selection);
  }

  selectedTeam() {
    return teamOfRobot(this.scene(), this.selection.robot);
  }

  // What is selected here is so in every record that has a thing of that name.
  select(/** @type {Selected} */ selection) {
    this.app.select(sameByName(this.history.mission, this.app.history.mission, selection));
  }

  pick(/** @type {Thing} */ thing) {
    this.select(thing);
  }

  go(step) {
    this.app.go(step);
  }

  show() {
    this.app.show(true);
  }

  redraw() {
    this.app.redraw();
  }

  alignGantts(/** @type {Gantt} */ gantt) {
    this.app.alignGantts(gantt);
  }

  title() {
    return titleOf(this.app.trials, this.trial);
  }

  titleItem() {
    return recordItem(this);
  }

  // What its captions say of the moment.
  caption() {
    const { name, state, dot, mapCanvas, ganttCanvas } = this.parts;
    name.textContent = this.title();
    state.textContent = describeProgress(this.history, this.player.step);
    dot.style.background = recordColour(this.app, this.trial);
    mapCanvas.setAttribute("aria-label", `Map of ${this.title()}: ${state.textContent}`);
    ganttCanvas.setAttribute("aria-label", `What each robot does over time, ${this.title()}`);
  }
}

function isAsLarge(/** @type {World} */ one, /** @type {World} */ other) {
  return ["width", "height", "isPlane", "yIsUp"].every((key) => one[key] === other[key]);
}

// A selection in one mission, in another one: what is called the same there, or nothing.
/** @returns {Selected} */
export function sameByName(/** @type {Mission} */ from, /** @type {Mission} */ to, /** @type {Selected} */ selection) {
  const namesOf = (mission) => ({ robot: mission.robots.map(nameOf), task: mission.tasks.map(nameOf), cap: mission.capabilities });
  const nameOf = ({ name }) => name;
  const [names, others] = [namesOf(from), namesOf(to)];
  const found = Object.entries(selection).map(([key, number]) => [key, others[key]?.indexOf(names[key][Number(number)])]);
  return Object.fromEntries(found.filter(([, number]) => number >= 0));
}
