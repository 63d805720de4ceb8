// The editor: the map of a draft, tools that change it, and the file reader's own words on it.

import { App } from "../app.js";
import { byId, targetOf } from "../panel/dom.js";
import { downloadButton } from "../panel/files.js";
import { showHeader } from "../panel/header.js";
import { LISTS } from "../panel/lists.js";
import { notify, notifyWork } from "../panel/notice.js";
import { download, fileName } from "../panel/saving.js";
import { capitalised } from "../record/lengths.js";
import { freeName, keepDraft, keptDraft, kindOf, numberOf, recordOfDraft, sizeOfWorld, withChange, withThing, withWall, withoutThing, writtenCounts } from "./draft.js";
import { EditorPanel } from "./panel.js";

const CHECK_AFTER = 250; // milliseconds without a change

export class EditorApp extends App {
  constructor({ mission, id }, link) {
    super(recordOfDraft(mission));
    this.link = link;
    this.draft = keptDraft(mission);
    this.id = this.told = id; // the names of what is drawn here, and of what the server knows of it
    this.tool = "move";
    this.problems = [];
    /** @type {Thing | null} */ this.held = null;
    this.hasDragged = false;
    this.panel = new EditorPanel(this, byId("mission"));
    document.body.classList.add("editing");
    this.lists.open("robots");
    this.options.lines = false;
    document.addEventListener("keydown", (event) => this.press(event), true);
    window.addEventListener("pagehide", () => keepDraft(this.draft));
  }

  startText() {
    return "";
  }

  // There is nothing yet but a map.
  look() {
    super.look("map");
  }

  // What is drawn, as JSON, which is a mission file too; YAML is what the panel saves.
  downloads() {
    const save = () => {
      const text = `${JSON.stringify(this.draft.tree, null, 1)}\n`;
      download(new Blob([text], { type: "application/json" }), `${fileName(this.draft.tree.name ?? "")}.json`);
    };
    return [downloadButton("Mission (JSON)", save)];
  }

  hear(message) {
    if (message.kind === "editor") this.replace(message);
    if (message.kind === "checked" && message.id === this.id) this.panel.tell((this.problems = message.problems));
    if (message.kind === "saved") notify(`Saved: ${message.paths.join(", ")}`, "good");
    if (message.kind === "starting") notifyWork(`${capitalised(message.text)} …`);
    if (message.kind === "refused") this.refuse(message);
  }

  refuse({ text }) {
    this.isOpening = false;
    notify(`Not done: ${text}.`);
  }

  ask(message) {
    if (this.link.send(message)) return true;
    notify("The server is not there; nothing was done. Trying again …");
    return false;
  }

  // Another file, or an empty drawing, which takes the place of this one in all pages.
  askToOpen(message) {
    this.isOpening = this.ask(message);
  }

  // Asks for something with what is drawn here, and says what it was drawn on: if that is no longer
  // what all pages show, the server refuses it.
  askWithDrawing(message) {
    if (this.ask(this.withDrawing(message))) this.told = this.id;
  }

  withDrawing(message) {
    return { ...message, mission: this.draft.tree, id: this.id, after: this.told };
  }

  // Another drawing: from a file, new, of another page, or of a server that began anew. One can go
  // back to what was drawn here.
  replace({ mission, file, id }) {
    if (file !== this.file) this.panel.file.value = this.file = file;
    if (id !== this.told) return this.takeOver(mission, id);
    this.isBehind = false;
    this.redrawDraft(this.selection);
  }

  takeOver(/** @type {MissionTree} */ mission, id) {
    const notice = this.isOpening ? [""] : this.noticeOfAnother();
    this.draft.change(mission, this.isOpening ? null : "another page");
    Object.assign(this, { id, told: id, held: null });
    this.panel.fill();
    this.redrawDraft(this.isOpening || !this.isThere(this.selection) ? {} : this.selection);
    this.isOpening = this.isBehind = false;
    notify(...notice);
  }

  noticeOfAnother() {
    if (this.isBehind) return ["The drawing was changed while the connection was lost. Undo goes back to yours."];
    if (this.id !== this.told) return ["Another page has changed the drawing. Undo goes back to yours."];
    return ["Another page is drawing too.", "plain"];
  }

  isThere(/** @type {Selected} */ selection) {
    const { robots, tasks } = this.draft.tree;
    return !(Number(selection.robot) >= robots.length || Number(selection.task) >= tasks.length);
  }

  // Every change goes through here; `selection` is what is to be selected then.
  change(/** @type {MissionTree} */ tree, /** @type {Selected} */ selection = this.selection, /** @type {string | null} */ key = null) {
    if (tree === this.draft.tree) return;
    this.draft.change(tree, key);
    this.haveDrawn(selection);
  }

  undo() {
    this.draft.undo();
    this.panel.fill();
    this.haveDrawn({});
  }

  redo() {
    this.draft.redo();
    this.panel.fill();
    this.haveDrawn({});
  }

  haveDrawn(/** @type {Selected} */ selection) {
    this.id = freshId();
    this.redrawDraft(selection);
  }

  redrawDraft(/** @type {Selected} */ selection) {
    const { camera } = this.map;
    const size = this.shownSize;
    const { tree } = this.draft;
    this.load(recordOfDraft(tree));
    this.shownSize = JSON.stringify(tree.world.plane ?? sizeOfWorld(tree.world));
    if (size === this.shownSize) Object.assign(this.map.camera, cameraPlace(camera));
    this.options.lines = false;
    this.options.names = true;
    this.select(selection);
    showHeader(this);
    this.panel.showHistory();
    this.check();
  }

  // Has the server keep what is drawn, show it to the other pages, and say what is wrong with it.
  check() {
    clearTimeout(this.checkTimer);
    const send = () => {
      if (this.link.send(this.withDrawing({ do: "check" }))) this.told = this.id;
    };
    this.checkTimer = setTimeout(send, CHECK_AFTER);
  }

  select(/** @type {Selected} */ selection) {
    super.select(selection);
    this.panel?.showThing();
  }

  useTool(tool) {
    this.tool = tool;
    this.panel.showTools();
    if (LISTS[`${tool}s`]) this.lists.open(`${tool}s`);
  }

  // The place in the draft's own lengths: a cell, or metres to the centimetre.
  /** @returns {Place} */
  placeOf(/** @type {Place} */ [x, y]) {
    const { world } = this.history.mission;
    const rounded = (along) => Number((along * world.square).toFixed(2));
    return world.isPlane ? [rounded(x), rounded(y)] : [Math.round(x), Math.round(y)];
  }

  isInside(/** @type {Place} */ [x, y]) {
    const { world } = this.history.mission;
    const [right, up] = [world.width * world.square, world.height * world.square];
    return x >= 0 && y >= 0 && (world.isPlane ? x <= right && y <= up : x < right && y < up);
  }

  pick(/** @type {Thing} */ thing, where) {
    const at = this.placeOf(where);
    const isThing = thing.robot !== undefined || thing.task !== undefined;
    if (this.tool === "erase" && isThing) return this.remove(thing);
    if (!this.isInside(at)) return this.select({});
    if (this.tool === "robot" || this.tool === "task") return this.add(`${this.tool}s`, at);
    if (this.tool === "wall" || this.tool === "erase") return this.paint(at, this.tool === "wall");
    this.select(isThing ? thing : {});
  }

  add(kind, at) {
    const { tree } = this.draft;
    const counts = writtenCounts(this.panel.kit(kind));
    const name = freeName(tree, kind);
    const thing = kind === "robots" ? { name, at, can: counts } : { name, at, needs: counts };
    const number = tree[kind].length;
    this.change(withThing(tree, kind, thing), kind === "robots" ? { robot: number } : { task: number });
  }

  remove(/** @type {Thing} */ thing) {
    this.change(withoutThing(this.draft.tree, thing), {});
  }

  paint(at, isWall) {
    if (this.draft.tree.world.plane) return notify("A plane has no walls.");
    this.change(withWall(this.draft.tree, at, isWall), {}, "walls");
  }

  // Dragging moves a thing or paints walls; elsewhere it moves the map.
  hold(/** @type {Thing} */ thing, where) {
    this.heldAt = this.placeOf(where);
    const isThing = thing.robot !== undefined || thing.task !== undefined;
    this.held = this.tool === "move" && isThing ? thing : null;
    this.hasDragged = false;
  }

  drag(where) {
    const at = this.placeOf(where);
    const isPainting = this.tool === "wall" || this.tool === "erase";
    if (!this.held && !isPainting) return false;
    if (!this.isInside(at)) return true;
    if (isPainting && !this.hasDragged) this.paint(this.heldAt, this.tool === "wall");
    this.hasDragged = true;
    if (isPainting) this.paint(at, this.tool === "wall");
    else if (this.held) this.moveTo(this.held, at);
    return true;
  }

  drop() {
    const { hasDragged } = this;
    this.held = null;
    this.hasDragged = false;
    this.draft.key = null;
    return hasDragged;
  }

  moveTo(/** @type {Thing} */ thing, at) {
    const { tree } = this.draft;
    const was = tree[kindOf(thing)][numberOf(thing)].at;
    if (was[0] === at[0] && was[1] === at[1]) return;
    this.change(withChange(tree, thing, { at }), thing, `move ${kindOf(thing)} ${numberOf(thing)}`);
  }

  // Arrows move what is selected by a cell, Delete removes it, Ctrl-Z and Ctrl-Y go back and on.
  press(/** @type {KeyboardEvent} */ event) {
    if (targetOf(event).matches("input, select, textarea") || document.querySelector("dialog[open]")) return;
    const act = this.keyAction(event);
    if (!act) return;
    event.preventDefault();
    event.stopPropagation();
    act();
  }

  keyAction(/** @type {KeyboardEvent} */ { key, ctrlKey, metaKey, shiftKey }) {
    const isCommand = ctrlKey || metaKey;
    if (isCommand && key.toLowerCase() === "z") return () => (shiftKey ? this.redo() : this.undo());
    if (isCommand && key.toLowerCase() === "y") return () => this.redo();
    const { robot, task } = this.selection;
    if (isCommand || (robot === undefined && task === undefined)) return null;
    if (key === "Delete" || key === "Backspace") return () => this.remove(this.selection);
    const by = ARROWS[key];
    return by ? () => this.nudge(by) : null;
  }

  nudge([right, up]) {
    const { world } = this.history.mission;
    const length = world.isPlane ? 0.1 : 1;
    const [x, y] = this.draft.tree[kindOf(this.selection)][numberOf(this.selection)].at;
    const down = world.yIsUp ? up : -up;
    const moved = (from, by) => Number((from + by * length).toFixed(2));
    /** @type {Place} */ const at = [moved(x, right), moved(y, down)];
    if (this.isInside(at)) this.moveTo(this.selection, at);
  }

  address() {
    return "";
  }

  openFiles(files) {
    this.panel.send(files);
  }
}

const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

// A name for a drawing that no other page gives.
function freshId() {
  return Array.from({ length: 3 }, () => Math.random().toString(36).slice(2)).join("");
}

function cameraPlace({ cell, left, top, isFitted }) {
  return { cell, left, top, isFitted };
}
