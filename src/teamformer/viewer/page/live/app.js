// The page of a mission under way: the same map and lists, fed by the server, and incidents.

import { App } from "../app.js";
import { messageOf } from "../panel/attempt.js";
import { act, byId, element } from "../panel/dom.js";
import { downloadButton } from "../panel/files.js";
import { noticeText, showHeader } from "../panel/header.js";
import { notify, notifyParts, notifyWork } from "../panel/notice.js";
import { download, fileName } from "../panel/saving.js";
import { isLost, leave } from "../record/history.js";
import { capitalised } from "../record/lengths.js";
import { isFreeCell } from "../record/mission.js";
import { isOver } from "../record/scene.js";
import { robotName } from "../record/words.js";
import { alertsToSee, bannerOfAlerts, namesOfAlerts, readAlerts } from "./alerts.js";
import { MissionPanel, describeOutcome } from "./panel.js";
import { LivePlayer } from "./player.js";

export class LiveApp extends App {
  constructor(/** @type {RecordTree} */ record, link) {
    super(record, new LivePlayer((message) => this.ask(message)));
    this.link = link;
    /** @type {LiveState} */ this.state = { incidents: [], watchers: 1, alerts: [] };
    this.isCutOff = false;
    /** @type {string | null} */ this.doubted = null; // what waits for a second click
    this.panel = new MissionPanel(this, byId("mission"));
  }

  // The steps as the server told them are kept, for planes are drawn in other lengths.
  load(/** @type {any} */ record) {
    /** @type {StepTree[]} */ this.steps = [...(record.steps ?? [])];
    this.known = record.events?.length ?? 0; // events
    super.load(record);
  }

  // The present, which in continuous time lies within a tick.
  present() {
    return this.history.until ?? this.history.last;
  }

  clock() {
    return /** @type {import("./player.js").LivePlayer} */ (this.player);
  }

  lastStep() {
    return this.history.last;
  }

  startText() {
    const isOpen = this.history.end.status === "running" && !this.state?.isFleet;
    return isOpen && this.history.last === 0 && !this.player.isPlaying ? "Start the mission" : "";
  }

  // What takes long is shown at once to be under way.
  ask(message) {
    const work = WORK[message.do];
    if (work) notifyWork(`${work} …`);
    if (!this.link.send(message)) notify("The server is not there; nothing was done. Trying again …");
  }

  hear(told) {
    const message = timesInTicks(told, this.player.tick);
    const { kind } = message;
    if ("is_playing" in message) this.tellPlanning(message.planning ?? ""); // before other notices
    if (kind === "mission") this.reopen(message);
    if (kind === "step") this.take(message);
    if (kind === "moment") this.takeMoment(told);
    if (kind === "incident") this.change(message);
    if (kind === "bound") this.learnBound(message.lower_bound);
    if ("is_playing" in message) this.takeState(message);
    if (["forecast", "what_if", "offer"].includes(kind)) this.panel.tell(message);
    if (kind === "searching") this.panel.searching(message);
    if (kind === "stopped") this.panel.stopWeighing();
    if (kind === "luck") this.panel.tellLuck(message);
    if (kind === "warning") notify(`${capitalised(message.text)}.`);
    if (kind === "saved") notify(savedText(message), "good");
    if (kind === "refused") this.refuse(message);
  }

  // The whole mission so far: the line was down, it begins anew, or an incident was undone.
  reopen({ record, text, id, now }) {
    const { selection, options } = this;
    const isOther = this.state.id !== undefined && this.state.id !== id;
    this.load({ ...record, now });
    Object.assign(this, { selection: this.knows(selection) ? selection : {}, options });
    this.showAll();
    this.state.alerts = []; // the banner is told anew
    this.panel?.forget();
    if (text) notify(text, "plain");
    if (isOther) notify(`The server was restarted with another mission. ${HOW_TO_RESUME}`);
  }

  knows({ task = 0 }) {
    return task < this.history.mission.tasks.length;
  }

  refuse({ text, keys = [], is_weighed: isWeighed = false }) {
    notify(`Not done: ${text}.`);
    if (isWeighed) this.panel.clear();
    this.panel.keepForm(keys);
  }

  // A step; one that does not follow the last is of a line that broke, and is told anew.
  take(/** @type {Message} */ { at, step, told, orders = [], plans = [], end }) {
    const { history } = this;
    if (at !== history.last + 1) return;
    history.record.orders.push(...orders);
    (history.record.plans ??= []).push(...plans);
    this.steps.push(step);
    history.grow(step, told, end);
    this.follow();
    if (end) this.tellEnd();
  }

  // Time that has passed, and what has happened in it; what does not follow is of a line that broke.
  takeMoment(/** @type {Message} */ news) {
    const { history } = this;
    if (news.from !== this.known) return;
    this.known += news.events.length;
    history.grow(news);
    this.follow();
    if (news.end) this.tellEnd();
  }

  tellEnd() {
    const { mission, end } = this.history;
    const text = noticeText(this.history) || `${capitalised(describeOutcome(mission.world, this.outcome()))}.`;
    notify(text, end.status === "completed" ? "good" : "");
  }

  // How the mission has ended, and when.
  outcome() {
    const { end, isContinuous } = this.history;
    return isContinuous ? { ...end, steps: this.present() } : end;
  }

  // An incident changes what is known; of the past, only what the latest step led to.
  change({ record, text, is_loss: isLoss, now }) {
    const { selection, options } = this;
    if (this.history.isContinuous) this.load({ ...record, now });
    else this.load({ ...record, steps: this.steps.slice(0, -record.steps.length || undefined).concat(record.steps) });
    Object.assign(this, { selection, options });
    showHeader(this);
    this.follow();
    this.panel.forget();
    this.panel.taskIsAdded();
    notify(`Incident ${this.history.isContinuous ? "at" : "in"} ${text}.`, isLoss ? "" : "plain");
  }

  // By task, the step in which it will be done if nothing more happens.
  expect(doneAt) {
    this.history.expected = doneAt;
    this.show(true);
  }

  // No plan can beat it, as worked out while the page was there already.
  learnBound(bound) {
    this.history.lowerBound = bound;
    this.timeline.draw();
    this.show(true);
  }

  takeState(/** @type {Message} */ state) {
    const { is_playing, speed, watchers, incidents, leaving = [], planning = "" } = state;
    const { is_fleet = false, has_editor = false, undo_to = null, saved_at = null, id } = state;
    const { is_heard = true, is_over = false } = state; // of a fleet
    const alerts = readAlerts(state.alerts ?? [], this.state.alerts);
    this.tellAlerts(alerts);
    const ofMission = { planning, hasEditor: has_editor, undoTo: undo_to, savedAt: saved_at, id };
    this.state = { watchers, incidents, alerts, ...ofMission, isFleet: is_fleet, isHeard: is_heard, isOver: is_over };
    document.body.classList.toggle("of-fleet", is_fleet);
    const { robots } = this.history.mission;
    leave(this.history, leaving.map((name) => robots.findIndex((robot) => robot.name === name)));
    this.player.isPlaying = is_playing;
    this.clock().hearSpeed(speed);
    this.panel.show();
    this.show(true);
  }

  // What has happened is shown before the plan for it is there.
  tellPlanning(planning) {
    if (planning) notifyWork(`${capitalised(planning)}; planning …`);
    else if (this.state.planning) notify("");
  }

  isUnheard() {
    return this.state?.isHeard === false;
  }

  // What nobody has acknowledged of a fleet is a banner, and counted in the title of the window.
  tellAlerts(/** @type {Alert[]} */ alerts) {
    if (namesOfAlerts(alerts) === namesOfAlerts(this.state.alerts)) return;
    const [count, wasCount] = [alerts, this.state.alerts].map((all) => alertsToSee(all).length);
    document.title = `${count ? `(${count}) ` : ""}${this.history.mission.name}, live`;
    if (count) notifyParts(bannerOfAlerts(alerts));
    else if (wasCount) notify(alerts.length ? "All alerts are acknowledged." : "No alerts any more.", "good");
  }

  // How a mission stands that is not over; a record's own word for that is another.
  statusText() {
    const { player, history, state } = this;
    if (state.isFleet && player.isFollowing) return fleetStatus(state);
    if (!player.isFollowing || history.end.status !== "running") return "";
    if (player.isPlaying) return "running";
    return history.last ? "paused" : "not started";
  }

  // The server makes them, as the command line does, of all that was done so far.
  downloads() {
    return Object.entries(FILES).map(([name, text]) => downloadButton(text, () => this.fetchFile(name)));
  }

  async fetchFile(name) {
    notifyWork(`Making ${name} …`);
    try {
      const answer = await fetch(`/download/${name}${location.search}`);
      if (!answer.ok) throw new Error((await answer.text()).trim());
      download(await answer.blob(), `${fileName(this.history.mission.name)}-${name}`);
      notify("");
    } catch (error) {
      notify(`${name} is not there: ${messageOf(error)}.`);
    }
  }

  follow() {
    this.events = this.history.events.filter(({ kind }) => kind !== "heads");
    byId("scrub").max = String(this.history.last);
    this.clock().grow(this.history.last);
    this.timeline.draw();
    this.panel.show();
  }

  // A free place opens the form of a new task there.
  pick(/** @type {Thing} */ thing, place) {
    const at = this.freePlace(place);
    if (Object.keys(thing).length || at === null) return this.select(thing);
    this.panel.askForTask(at);
  }

  freePlace(/** @type {Place} */ [x, y]) {
    const { world } = this.history.mission;
    if (world.roads) return placeNear(world, [x, y]);
    if (world.isPlane) {
      const at = [x, y].map((along) => Number((along * world.square).toFixed(2)));
      return x >= 0 && y >= 0 && x <= world.width && y <= world.height ? at : null;
    }
    /** @type {Place} */ const at = [Math.round(x), Math.round(y)];
    return isFreeCell(world, ...at) ? at : null;
  }

  actionsFor(robot) {
    if (this.state.isFleet) return []; // its robots are lost and back by themselves
    const { last, mission, record, isContinuous } = this.history;
    const name = robotName(mission, robot);
    const isGone = isLost(this.history, robot, last);
    const isLeaving = this.history.leaving.has(robot);
    const { back = [] } = record.mission.robots[robot]; // a step, or a list if several
    if (!isContinuous && (isLeaving || (isGone && [back].flat().includes(last + 1)))) {
      const what = isLeaving ? "is out of the mission" : "is there again";
      return [element("p", { class: "muted" }, `${name} ${what} from the next step on.`)];
    }
    const [words, incident] = isGone ? [`Bring ${name} back`, { back: name }] : [`Lose ${name}`, { lost: name }];
    const weighing = isGone ? "What would that gain?" : "What would that cost?";
    return [
      element(
        "div",
        { class: "acts" },
        ...(isGone ? [act(words, () => this.ask({ do: "happen", ...incident }), `back ${robot}`)] : this.askTwice(`lose ${robot}`, words, "Keep it", incident)),
        act(weighing, () => this.panel.weigh(incident), `weigh ${robot}`),
      ),
    ];
  }

  // An open task can be called off and, in a mission with a cost or optional tasks, get another weight.
  actionsForTask(task) {
    const { last, mission, isContinuous } = this.history;
    const { name, cancelled } = mission.tasks[task];
    const isCalledOff = !isContinuous && cancelled <= last + 1;
    if (isOver(this.history, task, last) || isCalledOff) return [];
    const incident = { cancelled: name };
    const callOff = this.askTwice(`call off ${task}`, `Call ${name} off`, "Keep it", incident);
    if (this.state.isFleet) return [element("div", { class: "acts" }, ...callOff)];
    return [
      element(
        "div",
        { class: "acts" },
        ...callOff,
        act("What would that gain?", () => this.panel.weigh(incident), `weigh task ${task}`),
      ),
      ...(mission.cost || mission.tasks.some(({ said }) => said.optional) ? [this.weightForm(task)] : []),
    ];
  }

  weightForm(task) {
    const { name, weight } = this.history.mission.tasks[task];
    const input = element("input", { type: "number", min: 0.001, step: "any", value: weight, "data-key": `weight ${task}` });
    const set = () => this.ask({ do: "happen", weighs: name, weight: Number(input.value) });
    return element("div", { class: "acts" }, element("label", {}, "Weight", input), act("Set weight", set, `set weight ${task}`));
  }

  // What takes something away takes a second click, elsewhere than the first.
  askTwice(key, words, keep, incident) {
    const doubt = (one) => () => {
      this.doubted = one;
      this.show(true);
    };
    if (this.doubted !== key) return [act(`${words} …`, doubt(key), key)];
    const go = () => {
      this.doubted = null;
      this.ask({ do: "happen", ...incident });
    };
    return [act(keep, doubt(null), key), act(`Yes, ${words[0].toLowerCase()}${words.slice(1)}`, go, `yes ${key}`)];
  }

  select(/** @type {Selected} */ selection) {
    this.doubted = null;
    super.select(selection);
  }

  // The address names the step only while one looks back.
  address() {
    const parts = new URLSearchParams(super.address());
    if (this.player.isFollowing) for (const key of ["step", "time"]) parts.delete(key);
    return parts.toString();
  }

  // What the server tells is about the mission, so that no other record takes its place.
  bringToFront(/** @type {Trial} */ trial) {
    if (trial !== this.trial) notify("A live mission stays in front; open the other record with `view` to see all of it.", "plain");
  }

  open() {
    notify("This page shows a live mission; put the record beside it, or open it with `view`.");
  }
}

// A message with its times in ticks, if there are ticks; what a moment brings is counted so by the history.
function timesInTicks(/** @type {Message} */ message, /** @type {number | null} */ tick) {
  if (tick === null || message.kind === "moment") return message;
  const span = (time) => (typeof time === "number" ? time / tick : time);
  const timed = Object.fromEntries(TIMES.filter((key) => key in message).map((key) => [key, span(message[key])]));
  for (const key of ["band", "done_at"]) if (message[key]) timed[key] = message[key].map(span);
  if (message.incidents) timed.incidents = message.incidents.map(([at, text]) => [span(at), text]);
  if (message.without) timed.without = timesInTicks(message.without, tick);
  return { ...message, ...timed };
}

// The keys of messages that hold times, but for `now`, which records have in the mission's unit.
const TIMES = ["undo_to", "saved_at", "steps", "at", "lower_bound"];

// The name of the place of roads that is nearest to a point; null if none is near.
function placeNear(/** @type {World} */ { roads, width, height }, /** @type {Place} */ [x, y]) {
  const away = (roads?.places ?? []).map((place) => Math.hypot(place[0] - x, place[1] - y));
  const nearest = away.indexOf(Math.min(...away));
  return away[nearest] <= Math.max(width, height) / 20 ? roads?.names[nearest] : null;
}

// What the server may take long for, by what is asked.
const WORK = {
  happen: "Telling the robots",
  undo: "Going back",
  restart: "Beginning anew",
  edit: "Going back to the drawing",
  take_over: "Taking it over",
  save: "Saving",
};

export const HOW_TO_RESUME = "`teamformer live --resume` goes on with a mission that was cut off.";

const FILES = {
  "mission.yaml": "Mission (YAML)",
  "record.json": "Record (JSON)",
  "record.html": "Page (HTML)",
  "tables.zip": "Tables (CSV, zip)",
  "record.mcap": "MCAP for Foxglove",
};

// How a fleet stands, which nobody here can pause.
function fleetStatus(/** @type {LiveState} */ { isOver, isHeard, alerts }) {
  if (isOver) return "completed";
  if (alerts.some(({ key }) => key === "all")) return "no robot heard";
  return isHeard ? "running" : "listening";
}

function savedText({ paths, note }) {
  return `Saved: ${paths.join(", ")}${note ? `; ${note}` : ""}`;
}
