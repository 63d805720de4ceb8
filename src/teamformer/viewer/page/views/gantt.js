// The Gantt view: robots down, time across, what each does, and which share of it is idle.

import { penOf, write } from "../draw/shapes.js";
import { element } from "../panel/dom.js";
import { percent } from "../record/lengths.js";
import { CHARGING, IDLE, LOST, OFF, PHASES, QUEUEING, deedsOfRobots, runsOf, stepsInPhases } from "../record/told.js";
import { PHASE_COLOURS, STRENGTHS, describeBar, drawBarsOfRow, drawEndsOfRow } from "./bars.js";
import { AXIS_HEIGHT, NAME_WIDTH, SHARE_WIDTH } from "./chart_sizes.js";
import { drawCriticalPath } from "./critical_path.js";
import { timeMarks } from "./time_canvas.js";

const ROW_HEIGHT = 22; // pixels; less where there are many robots
const LEAST_ROW_HEIGHT = 13; // names can be read
const STEP_WIDTH_MOST = 60; // pixels a step

export class Gantt {
  /** @type {{task: number, step: number}[][] | null} */ deeds = null; // by robot, worked out when they are drawn

  constructor(/** @type {Shown} */ app, /** @type {HTMLCanvasElement} */ canvas, /** @type {HTMLElement} */ legend) {
    this.app = app;
    this.canvas = canvas;
    this.legend = legend;
    this.still = document.createElement("canvas"); // all but the moment shown, drawn once until it changes
    this.factor = 1; // how many times as wide as its box the time is drawn
    this.sizer = /** @type {HTMLElement} */ (canvas.parentElement);
    this.box = /** @type {HTMLElement} */ (this.sizer.parentElement);
    this.width = this.height = 0; // pixels in sight
    this.sharpness = 1;
    this.madeFor = 0; // steps
    /** @type {any[]} */ this.stillShown = [];
    /** @type {any[]} */ this.legendTold = [];
    this.box.addEventListener("scroll", () => this.app.alignGantts(this));
    new ResizeObserver(() => this.app.redraw()).observe(this.box);
    canvas.addEventListener("click", (event) => this.click(event));
    canvas.addEventListener("pointermove", (event) => this.point(event));
    canvas.addEventListener("keydown", (event) => this.press(event));
    canvas.addEventListener("wheel", (event) => this.turn(event), { passive: false });
  }

  // Another record, or another length of this one.
  forget() {
    this.deeds = null;
  }

  runsOf(robot) {
    return runsOf(this.app.history, robot);
  }

  // The part of its time that a robot spent in a phase.
  shareOf(robot, phase) {
    const { history } = this.app;
    return Number(stepsInPhases(history, robot, history.last).get(phase)) / Math.max(1, history.last);
  }

  // Up and down go from robot to robot; the other keys are the page's own.
  press(/** @type {KeyboardEvent} */ event) {
    const by = { ArrowUp: -1, ArrowDown: 1 }[event.key];
    if (!by) return;
    event.preventDefault();
    const { length } = this.app.history.mission.robots;
    const robot = Math.max(0, Math.min(length - 1, (this.app.selection.robot ?? -1) + by));
    this.reveal(robot);
    this.app.select({ robot });
  }

  click(/** @type {{ offsetX: number, offsetY: number }} */ { offsetX, offsetY }) {
    const { app } = this;
    const robot = this.robotAt(offsetY);
    if (robot !== null) app.select({ robot });
    if (offsetX >= NAME_WIDTH) app.go(this.stepAt(offsetX));
    app.show(true);
  }

  // What is under the pointer, as the browser shows titles.
  point(/** @type {{ offsetX: number, offsetY: number }} */ { offsetX, offsetY }) {
    const robot = this.robotAt(offsetY);
    const isBar = robot !== null && offsetX >= NAME_WIDTH;
    this.canvas.title = isBar ? describeBar(this, robot, Math.ceil(this.timeAt(offsetX))) : "";
  }

  // The wheel scrolls; with Ctrl, or two fingers, time is drawn wider.
  turn(/** @type {WheelEvent} */ event) {
    if (!event.ctrlKey) return;
    event.preventDefault();
    this.zoom(Math.exp(-event.deltaY * 0.01), event.offsetX);
  }

  // Draw time wider or narrower; what is at a pixel, else at the moment shown, stays where it is.
  zoom(by, at = this.x(this.app.player.time)) {
    const time = this.timeAt(at);
    const most = (STEP_WIDTH_MOST * this.app.player.last) / this.room();
    this.factor = Math.max(1, Math.min(Math.max(1, most), this.factor * by));
    this.fit();
    this.box.scrollLeft += this.x(time) - at;
    this.app.alignGantts(this);
  }

  // All of the time in sight.
  fitAll() {
    this.factor = 1;
    this.app.alignGantts(this);
  }

  // Show the same time and the same rows as another chart.
  alignWith(/** @type {Gantt} */ { factor, box }) {
    this.factor = factor;
    this.fit();
    this.box.scrollLeft = box.scrollLeft;
    this.box.scrollTop = box.scrollTop;
  }

  reveal(robot) {
    const [top, row] = [robot * this.rowHeight(), this.rowHeight()];
    const high = this.box.clientHeight - AXIS_HEIGHT;
    const { scrollTop } = this.box;
    if (top < scrollTop) this.box.scrollTop = top;
    else if (top + row > scrollTop + high) this.box.scrollTop = top + row - high;
  }

  robotAt(y) {
    const robot = Math.floor((y + this.box.scrollTop - AXIS_HEIGHT) / this.rowHeight());
    return y >= AXIS_HEIGHT && robot < this.app.history.mission.robots.length ? robot : null;
  }

  rowHeight() {
    const room = (this.box.clientHeight - AXIS_HEIGHT - 8) / this.app.history.mission.robots.length;
    return Math.max(LEAST_ROW_HEIGHT, Math.min(ROW_HEIGHT, room));
  }

  x(step) {
    const part = step / Math.max(1, this.app.player.last);
    return NAME_WIDTH + part * this.timeWidth() - this.box.scrollLeft;
  }

  // Pixels that there are for time, and that all of it takes.
  room() {
    return this.box.clientWidth - NAME_WIDTH - SHARE_WIDTH - 6;
  }

  timeWidth() {
    return this.room() * this.factor;
  }

  timeAt(x) {
    const part = (x + this.box.scrollLeft - NAME_WIDTH) / this.timeWidth();
    return Math.max(0, Math.min(this.app.player.last, part * this.app.player.last));
  }

  stepAt(x) {
    return Math.round(this.timeAt(x));
  }

  stepsInSight() {
    return { from: this.timeAt(NAME_WIDTH), to: this.timeAt(this.width - SHARE_WIDTH) };
  }

  draw() {
    this.work();
    this.fit();
    if (!this.canvas.width || !this.canvas.height) return; // hidden
    this.follow();
    this.drawStill();
    const ctx = penOf(this.canvas);
    ctx.setTransform(1, 0, 0, 1, 0, 0);
    ctx.drawImage(this.still, 0, 0);
    ctx.scale(this.sharpness, this.sharpness);
    this.drawNow(ctx);
    this.showLegend();
  }

  // What does not change as the moment goes on: rows, axis, critical path.
  drawStill() {
    const { history, map, options, player, selection } = this.app;
    const { width, height } = this.canvas;
    const { scrollLeft, scrollTop } = this.box;
    const shown = [width, height, scrollLeft, scrollTop, this.factor, this.deeds, map.theme, options.bars, player.last, selection.robot];
    if (shown.every((value, place) => value === this.stillShown[place])) return;
    this.stillShown = shown;
    Object.assign(this.still, { width, height });
    const ctx = penOf(this.still);
    ctx.scale(this.sharpness, this.sharpness);
    ctx.fillStyle = map.theme.ground;
    ctx.fillRect(0, 0, this.width, this.height);
    const row = this.rowHeight();
    const first = Math.floor(this.box.scrollTop / row);
    const last = Math.min(history.mission.robots.length, first + Math.ceil(this.height / row) + 1);
    for (let robot = first; robot < last; robot++) {
      this.drawRow(ctx, robot, AXIS_HEIGHT + robot * row - this.box.scrollTop, row);
    }
    this.drawAxis(ctx);
    drawCriticalPath(ctx, this);
  }

  // Deeds are gathered once for each length of the record.
  work() {
    const { history } = this.app;
    if (this.deeds && this.madeFor === history.last) return;
    this.madeFor = history.last;
    this.deeds = deedsOfRobots(history);
  }

  fit() {
    this.width = this.box.clientWidth;
    this.height = this.box.clientHeight;
    this.sharpness = window.devicePixelRatio || 1;
    const [wide, high] = [this.width, this.height].map((side) => Math.round(side * this.sharpness));
    if (this.canvas.width !== wide) this.canvas.width = wide;
    if (this.canvas.height !== high) this.canvas.height = high;
    this.canvas.style.width = `${this.width}px`;
    this.canvas.style.height = `${this.height}px`;
    const rows = this.app.history.mission.robots.length * this.rowHeight();
    const { style } = this.sizer;
    style.height = `${Math.max(this.height, AXIS_HEIGHT + rows + 4)}px`;
    style.width = this.factor === 1 ? "" : `${this.width + this.timeWidth() - this.room()}px`;
  }

  // While it plays, the moment shown stays in sight.
  follow() {
    if (!this.app.player.isPlaying || this.factor === 1) return;
    const x = this.x(this.app.player.time);
    if (x < NAME_WIDTH || x > this.width - SHARE_WIDTH) this.box.scrollLeft += x - NAME_WIDTH - 20;
  }

  drawRow(/** @type {Canvas2D} */ ctx, robot, top, row) {
    const { map, selection } = this.app;
    if (selection.robot === robot) {
      ctx.fillStyle = map.theme.soft;
      ctx.fillRect(0, top, this.width, row);
    }
    drawBarsOfRow(ctx, this, robot, top, row);
    drawEndsOfRow(ctx, this, robot, top, row);
  }

  drawAxis(/** @type {Canvas2D} */ ctx) {
    const { history, map, player } = this.app;
    const { theme } = map;
    ctx.fillStyle = theme.surface;
    ctx.fillRect(0, 0, this.width, AXIS_HEIGHT - 2);
    const say = (text, x, align) => write(ctx, text, x, AXIS_HEIGHT / 2, theme.muted, `11px ${theme.font}`, align);
    for (const { step, text } of timeMarks(history.mission.world, player.last, this.timeWidth())) {
      const x = this.x(step);
      if (x >= NAME_WIDTH - 1 && x <= this.width - SHARE_WIDTH) say(text, x, "center");
    }
    say("idle", this.width - 10, "right");
    say("robot", NAME_WIDTH - 20, "right");
  }

  drawNow(/** @type {Canvas2D} */ ctx) {
    const x = this.x(this.app.player.time);
    if (x < NAME_WIDTH - 1 || x > this.width - SHARE_WIDTH + 1) return;
    ctx.fillStyle = this.app.map.theme.ink;
    ctx.fillRect(x - 0.75, AXIS_HEIGHT - 4, 1.5, this.height);
  }

  // The colours of all that robots do, and the fleet's mean shares; also what those hear who see no bars.
  showLegend() {
    const { map, options } = this.app;
    const told = [this.stillShown, this.app.titleItem()?.textContent];
    if (told.every((value, place) => value === this.legendTold[place])) return;
    this.legendTold = told;
    const robots = [...this.app.history.mission.robots.keys()];
    const mean = (phase) => robots.reduce((sum, robot) => sum + this.shareOf(robot, phase), 0) / robots.length;
    const isByTask = options.bars === "task";
    const items = PHASES.flatMap((name) => {
      if (!mean(name)) return [];
      const isOwn = [IDLE, LOST, OFF, CHARGING, QUEUEING].includes(name);
      const colour = isByTask && !isOwn ? map.theme.ink : map.theme[PHASE_COLOURS[name]];
      const dot = element("span", { class: "dot", colour });
      if (isByTask) dot.style.opacity = STRENGTHS[name];
      return [element("li", {}, dot, `${name} ${percent(mean(name))}`)];
    });
    const diamond = element("span", { class: "diamond" });
    items.push(element("li", {}, diamond, "a task done"));
    const frame = element("span", { class: "frame" });
    if (this.app.history.told.path.length) items.push(element("li", {}, frame, "critical path"));
    const title = this.app.titleItem();
    this.legend.replaceChildren(...(title ? [title] : []), ...items);
  }
}
