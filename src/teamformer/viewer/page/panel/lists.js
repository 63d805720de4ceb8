// The lists beside the map: events, tasks, teams, capabilities; each row leads somewhere.

import { taskColour } from "../draw/palette.js";
import { isLost } from "../record/history.js";
import { capitalised, describeMoment, shortMoment } from "../record/lengths.js";
import {
  MANY,
  describeCounts,
  describeDoing,
  describeEvent,
  describeLoss,
  describeShares,
  describeStanding,
  nameOfTeam,
  robotName,
  taskName,
} from "../record/words.js";
import { swatches } from "./chips.js";
import { byId, element, swatch, taskMark, teamMark } from "./dom.js";
import { describeCapability } from "./inspector.js";
import { Rows } from "./rows.js";

// What each list holds at a moment, how high its rows are and how one looks.
export const LISTS = {
  events: { height: 32, items: listedEvents, row: eventRow, empty: "Nothing happens." },
  tasks: { height: 48, items: listedTasks, row: taskRow, empty: "No such task." },
  teams: { height: 48, items: listedTeams, row: teamRow, empty: "No such team." },
  robots: { height: 48, items: listedRobots, row: robotRow, empty: "No such robot." },
  capabilities: {
    height: 48,
    items: listedCapabilities,
    row: capabilityRow,
    empty: "No such capability.",
  },
};

export class Lists {
  constructor(/** @type {App} */ app) {
    this.app = app;
    this.rows = new Rows(byId("rows"));
    this.current = "events";
    this.tabs = new Map(Object.keys(LISTS).map((name) => [name, this.tab(name)]));
    byId("tabs").replaceChildren(...this.tabs.values());
    byId("tabs").addEventListener("keydown", (event) => this.moveBetweenTabs(event));
    byId("filter").addEventListener("input", () => this.update());
  }

  tab(name) {
    const properties = { type: "button", role: "tab", id: `tab-${name}`, "aria-controls": "rows" };
    return element("button", { ...properties, on: () => this.open(name) }, capitalised(name));
  }

  moveBetweenTabs(/** @type {KeyboardEvent} */ event) {
    const by = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (!by) return;
    event.preventDefault();
    event.stopPropagation();
    const names = Object.keys(LISTS);
    const next = names[(names.indexOf(this.current) + by + names.length) % names.length];
    this.open(next);
    this.tabs.get(next)?.focus();
  }

  open(name) {
    this.current = name;
    byId("filter").value = "";
    this.rows.toTop();
    this.followed = undefined;
    this.follow();
  }

  // Show the list as it is at this moment.
  update() {
    for (const [name, tab] of this.tabs) {
      tab.setAttribute("aria-selected", String(name === this.current));
      tab.tabIndex = name === this.current ? 0 : -1;
    }
    byId("rows").setAttribute("aria-labelledby", `tab-${this.current}`);
    const { height, items, row, empty } = LISTS[this.current];
    const wanted = byId("filter").value.trim().toLowerCase();
    const isWanted = (describe) => !wanted || describe().toLowerCase().includes(wanted);
    this.items = items(this.app, isWanted);
    this.rows.show(this.items, height, (item) => row(this.app, item), empty, this.newest());
  }

  // The same, and scroll to what happened last.
  follow() {
    this.isFollowing = this.current === "events" && this.app.player.step !== this.followed;
    this.followed = this.app.player.step;
    this.update();
    this.isFollowing = false;
  }

  // The number of the item to scroll to: what happened last, if the list follows.
  newest() {
    if (!this.isFollowing) return null;
    const { step } = this.app.player;
    const after = this.items.findIndex((event) => event.step > step);
    return Math.max(0, (after < 0 ? this.items.length : after) - 1);
  }
}

function listedEvents(/** @type {App} */ app, isWanted) {
  return app.events.filter((event) => isWanted(() => describeEvent(app.history, event)));
}

function eventRow(/** @type {App} */ app, /** @type {HistoryEvent} */ event) {
  const { step } = app.player;
  const text = describeEvent(app.history, event);
  return {
    class: event.step === step ? "now" : event.step > step ? "ahead" : "",
    title: `${capitalised(describeMoment(app.history.mission.world, event.when ?? event.step))}: ${text}`,
    on: () => app.goToEvent(event),
    children: [
      element("span", { class: "when" }, shortMoment(app.history.mission.world, event.when ?? event.step)),
      element("span", { class: "dot", colour: eventColour(app, event) }),
      element("span", { class: "text" }, element("span", {}, text)),
    ],
  };
}

const EVENT_COLOURS = { join: "accent", split: "muted", lost: "bad", empty: "bad", charges: "task", queues: "wait", full: "task", back: "good", end: "ink" };

export function eventColour(/** @type {App} */ { map }, /** @type {HistoryEvent} */ { kind, task }) {
  return task === undefined ? map.theme[EVENT_COLOURS[kind]] : taskColour(task, map.isDark);
}

function listedTasks(/** @type {App} */ app, isWanted) {
  const { tasks } = app.history.mission;
  return tasks.map((_, task) => task).filter((task) => isWanted(() => tasks[task].name));
}

// What a row of two lines looks like: what it selects, its sign, and its lines.
function twoLines(/** @type {App} */ app, /** @type {Selected} */ selection, sign, first, second) {
  const [[kind, number]] = Object.entries(selection);
  const lines = element("span", { class: "text" }, element("span", {}, first), element("span", {}, second));
  return { class: app.selection[kind] === number ? "now" : "", on: () => app.select(selection), children: [sign, lines] };
}

function taskRow(/** @type {App} */ app, task) {
  const { history } = app;
  return twoLines(app, { task }, taskMark(app, task), taskName(history.mission, task), describeStanding(history, task, app.scene()));
}

function teamRow(/** @type {App} */ app, /** @type {Team} */ team) {
  const { history, player } = app;
  const size = team.robots.length > 1 ? ` (${team.robots.length})` : "";
  const row = twoLines(app, { robot: team.slot }, teamMark(app, team), nameOfTeam(history.mission, team) + size, describeDoing(history, team, player.step));
  return { ...row, class: app.selectedTeam() === team ? "now" : "" };
}

function robotRow(/** @type {App} */ app, robot) {
  const { mission } = app.history;
  const sign = element("span", { class: "swatches" }, ...swatches(app, mission.robots[robot].can));
  return twoLines(app, { robot }, sign, robotName(mission, robot), describeSoFar(app.history, robot, app.player.step));
}

function capabilityRow(/** @type {App} */ app, cap) {
  return twoLines(app, { cap }, swatch(app, cap), app.history.mission.capabilities[cap], describeCapability(app, cap));
}

function listedTeams(/** @type {App} */ app, isWanted) {
  const { mission } = app.history;
  const teams = [...app.scene().teams.values()];
  return teams.filter(({ robots }) => robots.some((robot) => isWanted(() => robotName(mission, robot))));
}

function listedRobots(/** @type {App} */ app, isWanted) {
  const { robots } = app.history.mission;
  return robots.map((_, robot) => robot).filter((robot) => isWanted(() => robots[robot].name));
}

// What a robot has done with its time; of one that is lost, since when it is.
function describeSoFar(/** @type {TrialHistory} */ history, robot, step) {
  if (isLost(history, robot, step)) return describeLoss(history, robot, step);
  if (step) return describeShares(history, robot, step);
  return `brings ${describeCounts(history.mission, history.mission.robots[robot].can, MANY)}`;
}

function listedCapabilities(/** @type {App} */ app, isWanted) {
  const names = app.history.mission.capabilities;
  return names.map((_, cap) => cap).filter((cap) => isWanted(() => names[cap]));
}

