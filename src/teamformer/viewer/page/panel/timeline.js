// The strip over the slider: tasks done over time, where teams form, the lower bound.

import { fillAs, strokeAs } from "../draw/shapes.js";
import { doneAfterSteps } from "../record/over_time.js";
import { TimeCanvas, traceSteps } from "../views/time_canvas.js";
import { eventColour } from "./lists.js";

const THUMB = 16; // pixels; the slider's ends are half of it inside the strip

export class Timeline extends TimeCanvas {
  constructor(/** @type {App} */ app, /** @type {HTMLCanvasElement} */ canvas) {
    super(app, canvas, THUMB / 2, THUMB / 2);
  }

  draw() {
    const ctx = this.cleared();
    if (!ctx) return;
    const height = this.canvas.clientHeight - 9;
    this.drawDone(ctx, height);
    this.drawMarks(ctx, height + 1);
    this.drawBound(ctx, 0, height);
  }

  drawDone(/** @type {Canvas2D} */ ctx, height) {
    const { history, map } = this.app;
    const [x, y] = [(step) => this.x(step), (count) => height - (count / history.doneAt.length) * (height - 2)];
    ctx.beginPath();
    traceSteps(ctx, doneAfterSteps(history), x, y);
    strokeAs(ctx, map.theme.accent, 1.5);
    ctx.lineTo(this.x(history.last), height);
    ctx.lineTo(this.x(0), height);
    fillAs(ctx, map.theme.accent, 0.16);
  }

  // Joins, splits, losses and returns, one tick each; those in the same pixel cover each other.
  drawMarks(/** @type {Canvas2D} */ ctx, top) {
    const drawn = new Set();
    for (const event of this.app.events) {
      if (!["join", "split", "lost", "empty", "back"].includes(event.kind)) continue;
      const x = Math.round(this.x(event.step));
      if (drawn.has(`${x} ${event.kind}`)) continue;
      drawn.add(`${x} ${event.kind}`);
      ctx.fillStyle = eventColour(this.app, event);
      ctx.fillRect(x - 0.75, top, 1.5, event.kind === "split" ? 4 : 7);
    }
  }
}
