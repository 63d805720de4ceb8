// Tasks done over time, a line for each record, and where each one's makespan is.

import { drawDisc, strokeAs, write } from "../draw/shapes.js";
import { describeAmount } from "../record/lengths.js";
import { doneAfterSteps } from "../record/over_time.js";
import { TimeCanvas, traceSteps } from "../views/time_canvas.js";
import { recordColour } from "./titles.js";

const CURVES_BELOW = 16; // pixels, for the time

export class Curves extends TimeCanvas {
  constructor(/** @type {App} */ app, /** @type {HTMLCanvasElement} */ canvas) {
    super(app, canvas, 30, 10);
  }

  // Of the part that is done, 0..1.
  y(part) {
    return 6 + (1 - part) * (this.canvas.clientHeight - CURVES_BELOW - 6);
  }

  draw() {
    const ctx = this.cleared();
    if (!ctx) return;
    this.drawAxes(ctx);
    this.drawBound(ctx, this.y(1), this.y(0));
    for (const trial of this.app.trials) this.drawLine(ctx, trial);
    this.drawNow(ctx, 2, this.y(0));
  }

  drawAxes(/** @type {Canvas2D} */ ctx) {
    const { map, player, history } = this.app;
    const { theme } = map;
    const { world } = history.mission;
    const bottom = this.canvas.clientHeight;
    ctx.strokeStyle = theme.line;
    ctx.strokeRect(this.x(0) - 0.5, this.y(1) - 0.5, this.room() + 1, this.y(0) - this.y(1) + 1);
    const say = (text, x, y, align, baseline) => write(ctx, text, x, y, theme.muted, `10px ${theme.font}`, align, baseline);
    say("100%", this.left - 4, this.y(1) + 2, "right", "middle");
    say("0", this.left - 4, this.y(0) - 2, "right", "middle");
    say(describeAmount(world, player.last), this.x(player.last), bottom, "right", "bottom");
    say(doneOver(world), this.left, bottom, "left", "bottom");
  }

  // The line of what was done, and a dot at the makespan.
  drawLine(/** @type {Canvas2D} */ ctx, /** @type {Trial} */ trial) {
    const { history } = trial;
    const [x, y] = [(step) => this.x(step), (count) => this.y(count / history.doneAt.length)];
    const colour = recordColour(this.app, trial);
    ctx.beginPath();
    traceSteps(ctx, doneAfterSteps(history), x, y);
    strokeAs(ctx, colour, trial === this.app.trial ? 2.5 : 1.5);
    if (history.end.makespan !== null) drawDisc(ctx, this.x(history.end.makespan), this.y(1), 3.5, colour);
  }
}

function doneOver(/** @type {World} */ { isTimed, secondsUnit }) {
  return `tasks done over ${!isTimed ? "steps" : secondsUnit ? "seconds" : "time"}`;
}
