// The page as a whole: one record, one clock, one selection; perhaps others beside it, in step.

import { Companion, sameByName } from "./compared/companion.js";
import { Compared, MOST_MAPS } from "./compared/panel.js";
import { recordItem } from "./compared/titles.js";
import { TrialMap } from "./draw/map.js";
import { capabilityColours, shortLabels } from "./draw/palette.js";
import { attempt } from "./panel/attempt.js";
import { connectControls } from "./panel/controls.js";
import { byId } from "./panel/dom.js";
import { connectFiles, openRecordFile, ownDownloads } from "./panel/files.js";
import { showFigures, showHeader } from "./panel/header.js";
import { showDetails } from "./panel/inspector.js";
import { Lists } from "./panel/lists.js";
import { VIEWS, describeNow, showPlayback, showSwitches } from "./panel/playback.js";
import { Timeline } from "./panel/timeline.js";
import { Player } from "./player.js";
import { frames } from "./record/history.js";
import { rememberLast } from "./record/keeping.js";
import { capitalised, describeMoment, describeSpan, secondsOf } from "./record/lengths.js";
import { sceneAt, teamOfRobot } from "./record/scene.js";
import { describeAt, describeEvent, robotName, taskName } from "./record/words.js";
import { ROBOT_COLUMNS, TASK_COLUMNS } from "./views/columns.js";
import { Gantt } from "./views/gantt.js";
import { Plots } from "./views/plots.js";
import { Table } from "./views/table.js";
import { Shown } from "./shown.js";

const LINES_UP_TO = 30; // teams; with more, the lines to assignments are off at first
const ADDRESS_EVERY = 300; // milliseconds, while it plays
const REST = 4; // lists rest so many times as long as they took, while it plays

const OPTIONS = { lines: true, trails: false, order: false, names: true, rings: "team", messages: true, bars: "phase", dim: false };

export class App extends Shown {
  /** @type {HistoryEvent[]} */ events; // all but where teams head for
  /** @type {Selected} */ selection = {};

  constructor(/** @type {RecordTree} */ record, player = new Player(0)) {
    super(player, { ...OPTIONS });
    player.changed = (isNewStep) => this.show(isNewStep);
    this.restUntil = 0;
    /** @type {MediaRecorder | null} */ this.recorder = null;
    this.view = "map";
    this.map = new TrialMap(this, byId("map"));
    this.lists = new Lists(this);
    this.timeline = new Timeline(this, byId("marks"));
    this.gantt = new Gantt(this, byId("gantt"), byId("phases"));
    this.plots = new Plots(this, byId("plots"));
    this.tables = {
      tasks: new Table(this, "task", TASK_COLUMNS, byId("stage-tasks")),
      robots: new Table(this, "robot", ROBOT_COLUMNS, byId("stage-robots")),
    };
    /** @type {Trial[]} */ this.trials = []; // all records in the order in which they were opened
    /** @type {Companion[]} */ this.companions = [];
    /** @type {{method: string, seed: number, why: string}[]} */ this.failed = []; // trials that left no record
    this.compared = new Compared(this, byId("compared"));
    this.load(record);
  }

  // Show a record in place of the one in front; what cannot be read throws before anything has changed.
  load(/** @type {RecordTree} */ record) {
    const trial = readTrial(record);
    this.trials = this.trial ? this.trials.map((other) => (other === this.trial ? trial : other)) : [trial];
    this.showTrial(trial);
    this.lineUp();
    this.player.reset(this.lastStep(), tickOf(trial.history));
    byId("scrub").max = String(this.player.last);
  }

  // Show one of the records as that which panel, lists, tables and timeline are about.
  showTrial(/** @type {Trial} */ trial) {
    this.put(trial);
    const { mission } = trial.history;
    this.events = trial.history.events.filter(({ kind }) => kind !== "heads");
    this.selection = {};
    this.options.lines = mission.robots.length <= LINES_UP_TO;
    this.options.names = mission.tasks.length <= 2 * LINES_UP_TO;
    this.options.rings = "team";
    this.map.look(mission.world);
    this.gantt.forget();
  }

  // Put records beside those that are shown, at the moment that is shown.
  putBeside(records, failed = []) {
    const tick = tickOf(this.history) ?? undefined;
    this.trials = [...this.trials, ...records.map((record) => readTrial(record, tick))];
    this.failed = [...this.failed, ...failed];
    this.lineUp();
    this.stretch();
  }

  close(/** @type {Trial} */ trial) {
    this.trials = this.trials.filter((other) => other !== trial);
    this.lineUp();
    this.stretch();
  }

  // The other records' maps and charts, in their order; the first ones only, if there are many.
  lineUp() {
    for (const companion of this.companions) companion.close();
    const others = this.trials.filter((trial) => trial !== this.trial);
    this.companions = others.slice(0, MOST_MAPS - 1).map((trial) => new Companion(this, trial));
    byId("stage-map").classList.toggle("several", this.companions.length > 0);
    byId("stage-gantt").classList.toggle("several", this.companions.length > 0);
    this.compared.layMaps();
  }

  // The clock goes as far as the longest record.
  stretch() {
    this.player.shorten(this.lastStep());
    byId("scrub").max = String(this.player.last);
    this.map.resize();
    this.showAll();
  }

  // Show another record's details; the two exchange their places.
  bringToFront(/** @type {Trial} */ trial) {
    if (trial === this.trial) return;
    const [was, { options }] = [this.trial, this];
    const kept = { ...options };
    const selection = sameByName(this.history.mission, trial.history.mission, this.selection);
    this.showTrial(trial);
    Object.assign(options, kept);
    this.selection = selection;
    const swapped = this.companions.find((companion) => companion.trial === trial);
    swapped?.showTrial(was);
    for (const other of this.companions) if (other !== swapped) other.showTrial(other.trial);
    this.showAll();
  }

  start() {
    connectControls(this);
    connectFiles(this);
    this.readAddress();
    addEventListener("hashchange", () => this.readAddress());
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.show(true));
    this.showAll();
  }

  // What the button over the map says before anything has been played; nothing, no button.
  startText() {
    const { player, history } = this;
    if (player.time > 0 || player.isPlaying || player.last === 0) return "";
    const { world } = history.mission;
    return history.isContinuous ? `Play the mission, until ${describeMoment(world, history.until)}` : `Play the mission ${describeSpan(world, player.last)}`;
  }

  // Everything that depends on the record and not on the moment, too.
  showAll() {
    showHeader(this);
    this.timeline.draw();
    this.show(true);
  }

  // A file that was chosen or dropped.
  openFiles(/** @type {File[]} */ [file], isBeside) {
    openRecordFile(this, file, isBeside);
  }

  // Open another record in place of all that are shown.
  open(/** @type {RecordTree} */ record) {
    this.trials = [this.trial];
    this.failed = [];
    this.load(record);
    this.map.resize();
    this.showAll();
  }

  // The buttons of the menu that save files of the mission.
  downloads() {
    return ownDownloads(this);
  }

  lastStep() {
    return Math.max(...this.trials.map(({ history }) => history.last));
  }

  // What can be done with a robot or a task while a mission is under way.
  /** @returns {HTMLElement[]} */
  actionsFor(robot) {
    return [];
  }

  /** @returns {HTMLElement[]} */
  actionsForTask(task) {
    return [];
  }

  // Whether it is of a fleet that nobody has heard yet.
  isUnheard() {
    return false;
  }

  // How a mission stands that is not over; of a record there is nothing to add.
  statusText() {
    return "";
  }

  selectedTeam() {
    return teamOfRobot(this.scene(), this.selection.robot);
  }

  select(/** @type {Selected} */ selection) {
    this.selection = selection;
    this.show(true);
  }

  toggle(option) {
    this.options[option] = !this.options[option];
    this.show(true);
  }

  // What was clicked on the map; where that is nothing, the place is for those who can add there.
  pick(/** @type {Thing} */ thing, /** @type {Place} */ place) {
    this.select(thing);
  }

  // What holds a thing on the map, drags it and lets it go; here nothing does, and the map moves.
  hold(/** @type {Thing} */ thing, /** @type {Place} */ place) {}

  drag(/** @type {Place} */ place) {
    return false;
  }

  drop() {
    return false;
  }

  // One of VIEWS.
  look(view) {
    this.view = view;
    this.show(true);
  }

  // Closer to the map, or more pixels for each step.
  zoom(factor) {
    if (this.view === "gantt") this.gantt.zoom(factor);
    else this.map.zoom(factor);
  }

  maps() {
    return [this.map, ...this.companions.map(({ map }) => map)];
  }

  gantts() {
    return [this.gantt, ...this.companions.map(({ gantt }) => gantt)];
  }

  // All charts show the time that one of them shows.
  alignGantts(/** @type {Gantt} */ gantt) {
    for (const other of this.gantts()) if (other !== gantt) other.alignWith(gantt);
    this.redraw();
  }

  // Over the Gantt chart, which record it is of, if there are several.
  titleItem() {
    return this.trials.length > 1 ? recordItem(this) : null;
  }

  fitView() {
    if (this.view === "gantt") this.gantt.fitAll();
    else this.map.fit();
  }

  go(step) {
    this.player.pause();
    this.player.go(step);
  }

  goToEvent(/** @type {HistoryEvent} */ event) {
    if (event.task !== undefined) this.selection = { task: event.task };
    else if (event.robots) this.selection = { robot: event.robots[0] };
    this.go(event.step);
    this.show(true);
  }

  // The nearest earlier (-1) or later (+1) step in which something happens.
  goToNextEvent(direction) {
    const { step } = this.player;
    const steps = this.events.map((event) => event.step);
    const next = direction > 0 ? steps.find((at) => at > step) : steps.findLast((at) => at < step);
    this.go(next ?? (direction > 0 ? this.player.last : 0));
  }

  // `#step=12&task=crate-7`, in continuous time `#time=4.5`, or `&robot=r1`, or `&capability=lift`; `&view=gantt`, or another of VIEWS.
  readAddress() {
    const wanted = new URLSearchParams(location.hash.slice(1));
    const { robots, tasks, capabilities } = this.history.mission;
    const task = tasks.findIndex(({ name }) => name === wanted.get("task"));
    const robot = robots.findIndex(({ name }) => name === wanted.get("robot"));
    const cap = capabilities.findIndex((name) => name === wanted.get("capability"));
    if (task >= 0) this.select({ task });
    else if (robot >= 0) this.select({ robot });
    else if (cap >= 0) this.select({ cap });
    this.look(VIEWS.find((view) => view === wanted.get("view")) ?? "map");
    if (wanted.has("step")) this.go(Math.round(Number(wanted.get("step"))) || 0);
    if (wanted.has("time")) this.go(Math.round(Number(wanted.get("time")) / this.history.mission.world.stepSeconds) || 0);
  }

  // The address follows, so that a copy of it opens the page at this moment.
  writeAddress() {
    this.addressTimer ??= setTimeout(() => {
      this.addressTimer = undefined;
      window.history.replaceState(null, "", `#${this.address()}`);
    }, ADDRESS_EVERY);
  }

  address() {
    const { mission } = this.history;
    const { task, robot, cap } = this.selection;
    const { step } = this.player;
    const parts = new URLSearchParams();
    if (this.history.isContinuous) parts.set("time", String(secondsOf(mission.world, step)));
    else parts.set("step", String(step));
    if (task !== undefined) parts.set("task", taskName(mission, task));
    if (robot !== undefined) parts.set("robot", robotName(mission, robot));
    if (cap !== undefined) parts.set("capability", mission.capabilities[cap]);
    if (this.view !== "map") parts.set("view", this.view);
    return parts.toString();
  }

  redraw() {
    if (this.isDrawing) return;
    this.isDrawing = true;
    requestAnimationFrame(() => {
      this.isDrawing = false;
      for (const companion of this.companions) attempt("the captions", () => companion.caption());
      for (const drawing of this.drawings()) attempt("the drawing", () => drawing.draw());
    });
  }

  // What is drawn on canvases in this view, that of the record in front first; tables are not drawn.
  drawings() {
    if (this.view === "map") return this.maps();
    return this.view === "gantt" ? this.gantts() : this.view === "plots" ? [this.plots] : [];
  }

  // Bring the page to the moment and the selection that hold now.
  show(isNewStep) {
    this.redraw();
    if (!isNewStep || this.isShowing) return;
    this.isShowing = true;
    const wait = this.player.isPlaying ? this.restUntil - performance.now() : 0;
    const soon = () =>
      requestAnimationFrame(() => {
        this.isShowing = false;
        const begun = performance.now();
        this.showStep();
        const ended = performance.now();
        this.restUntil = ended + REST * (ended - begun);
      });
    if (wait > 0) setTimeout(soon, wait);
    else soon();
  }

  showStep() {
    attempt("the figures", () => showFigures(this));
    attempt("the details", () => showDetails(this));
    attempt("the comparison", () => this.compared.show());
    attempt("the lists", () => this.lists.follow());
    attempt("the table", () => this.tables[this.view]?.show());
    showPlayback(this);
    showSwitches(this);
    this.writeAddress();
    const { mission } = this.history;
    const title = `Map of ${mission.name} ${describeAt(mission.world, this.player.step)}`;
    this.map.canvas.setAttribute("aria-label", title);
    if (!this.player.isPlaying) this.say();
  }

  // What happens in this step, for those who listen.
  say() {
    const { step } = this.player;
    const texts = this.events.filter((event) => event.step === step).slice(0, 8);
    const said = texts.map((event) => describeEvent(this.history, event)).join("; ");
    byId("said").textContent = `${capitalised(describeNow(this))}. ${said}`;
  }
}

const SCENES_KEPT = 40;

// How long a step of a record in continuous time is, in the mission's unit; null of one in steps.
function tickOf(/** @type {TrialHistory} */ { isContinuous, mission }) {
  return isContinuous ? mission.world.stepSeconds : null;
}

// A record with what is worked out from it once.
function readTrial(/** @type {RecordTree} */ record, /** @type {number | undefined} */ tick = undefined) {
  const history = frames(record, tick);
  const { capabilities } = history.mission;
  return {
    record,
    history,
    colours: capabilityColours(capabilities.length),
    labels: shortLabels(capabilities),
    sceneAt: sceneKeeper(history),
  };
}

// Returns what gives the scene after a step, the last few of which are kept.
function sceneKeeper(/** @type {TrialHistory} */ history) {
  const keep = () => rememberLast(SCENES_KEPT, (at) => sceneAt(history, at));
  let { leaving } = history;
  let scenes = keep();
  return (step) => {
    if (history.leaving !== leaving) scenes = keep();
    leaving = history.leaving;
    return scenes(step);
  };
}
