// Plots over time: open tasks, idle robots, and the way that the fleet has made.

import { fillAs, strokeAs, write } from "../draw/shapes.js";
import { capitalised, describeMoment, describeSpan, describeWay } from "../record/lengths.js";
import { curvesOf } from "../record/over_time.js";
import { TimeCanvas, timeMarks, traceSteps } from "./time_canvas.js";

const PLOTS = [
  { key: "open", title: "Open tasks", colour: "accent", say: sayCount, mark: sayCount },
  { key: "idle", title: "Idle robots", colour: "muted", say: sayCount, mark: sayCount },
  { key: "way", title: "Way of all robots", colour: "good", say: sayWay, mark: shortWay },
];

function sayCount(_, value) {
  return String(value);
}

// A way where the title says what it is: in cells or metres.
function shortWay(/** @type {World} */ world, length) {
  return world.roads ? describeSpan(world, length) : String(Math.round(length * (world.square ?? 1)));
}

function sayWay(/** @type {World} */ world, length) {
  return world.roads ? `${describeSpan(world, length)}, as time` : describeWay(world, length);
}

const PLOT_HEAD = 30; // pixels
const PLOT_FOOT = 22;

export class Plots extends TimeCanvas {
  constructor(/** @type {App} */ app, /** @type {HTMLCanvasElement} */ canvas) {
    super(app, canvas, 52, 18);
  }

  draw() {
    const ctx = this.cleared();
    if (!ctx) return;
    const { canvas, app } = this;
    const { clientWidth: width, clientHeight: height } = canvas;
    ctx.fillStyle = app.map.theme.ground;
    ctx.fillRect(0, 0, width, height);
    const curves = curvesOf(app.history);
    const high = (height - PLOT_FOOT) / PLOTS.length;
    PLOTS.forEach((plot, number) => this.drawPlot(ctx, plot, curves[plot.key], number * high, high));
    this.drawTimes(ctx);
    this.drawNow(ctx, 4, height - PLOT_FOOT);
    canvas.setAttribute("aria-label", this.said());
  }

  // What the plots say of the moment, or of the end of a record that is over by then.
  said() {
    const { history, player } = this.app;
    const step = Math.min(player.step, history.last);
    const curves = curvesOf(history);
    const { world } = history.mission;
    const values = PLOTS.map(({ key, title, say }) => `${title.toLowerCase()} ${say(world, curves[key][step])}`);
    return `${capitalised(describeMoment(world, step))}: ${values.join(", ")}`;
  }

  drawPlot(/** @type {Canvas2D} */ ctx, { title, colour, say, mark }, values, top, high) {
    const { map, history, player } = this.app;
    const { theme } = map;
    const [ceiling, floor] = [top + PLOT_HEAD, top + high - 8];
    const most = values.reduce((one, other) => Math.max(one, other), 1);
    const y = (value) => floor - (value / most) * (floor - ceiling);
    const { world } = history.mission;
    const now = say(world, values[Math.min(player.step, history.last)]);
    write(ctx, `${title}: ${now}`, this.left, top + 16, theme.ink, `600 13px ${theme.font}`, "left");
    for (const value of [0, most]) {
      write(ctx, mark(world, value), this.left - 7, y(value), theme.muted, `11px ${theme.font}`, "right");
      ctx.fillRect(this.left, Math.round(y(value)), this.room(), 0.5);
    }
    ctx.beginPath();
    traceSteps(ctx, values, (step) => this.x(step), y);
    strokeAs(ctx, theme[colour], 1.8);
    ctx.lineTo(this.x(values.length - 1), floor);
    ctx.lineTo(this.x(0), floor);
    fillAs(ctx, theme[colour], 0.13);
  }

  drawTimes(/** @type {Canvas2D} */ ctx) {
    const { history, map, player } = this.app;
    for (const { step, text } of timeMarks(history.mission.world, player.last, this.room())) {
      write(ctx, text, this.x(step), this.canvas.clientHeight - PLOT_FOOT / 2, map.theme.muted, `11px ${map.theme.font}`);
    }
  }
}
