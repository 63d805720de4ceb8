// A canvas with time from left to right, from the start to the page's last step.

import { penOf, strokeAs, traceLine, write } from "../draw/shapes.js";
import { SPACINGS } from "../draw/world.js";

const MARKS_APART = 46; // pixels between two numbers of an axis, at least

export class TimeCanvas {
  // `left` and `right` are the pixels that are left free for numbers.
  constructor(/** @type {App} */ app, /** @type {HTMLCanvasElement} */ canvas, /** @type {number} */ left, /** @type {number} */ right) {
    this.app = app;
    this.canvas = canvas;
    this.left = left;
    this.right = right;
    new ResizeObserver(() => app.history && this.draw()).observe(canvas);
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      this.goTo(event);
    });
    canvas.addEventListener("pointermove", (event) => event.buttons && this.goTo(event));
  }

  draw() {}

  goTo(/** @type {PointerEvent} */ { offsetX }) {
    const part = (offsetX - this.left) / this.room();
    this.app.go(Math.round(part * this.app.player.last));
  }

  room() {
    return this.canvas.clientWidth - this.left - this.right;
  }

  x(step) {
    return this.left + (step / Math.max(1, this.app.player.last)) * this.room();
  }

  // What to draw on: all of the canvas, empty. Nothing while it is hidden.
  cleared() {
    const { canvas } = this;
    if (!canvas.clientWidth) return null;
    const sharpness = window.devicePixelRatio || 1;
    canvas.width = Math.round(canvas.clientWidth * sharpness);
    canvas.height = Math.round(canvas.clientHeight * sharpness);
    const ctx = penOf(canvas);
    ctx.scale(sharpness, sharpness);
    return ctx;
  }

  drawNow(/** @type {Canvas2D} */ ctx, top, bottom) {
    ctx.fillStyle = this.app.map.theme.ink;
    ctx.fillRect(this.x(this.app.player.time) - 0.75, top, 1.5, bottom - top);
  }

  // The bound on the makespan, as long as time is shown so far.
  drawBound(/** @type {Canvas2D} */ ctx, top, bottom) {
    const { history, map, player } = this.app;
    if (history.lowerBound === null || history.lowerBound > player.last) return;
    const x = this.x(history.lowerBound);
    const isRight = x > this.left + 50;
    traceLine(ctx, [{ x, y: top }, { x, y: bottom }]);
    strokeAs(ctx, map.theme.muted, 1, { dash: [3, 2] });
    const [at, side] = isRight ? [x - 4, "right"] : [x + 4, "left"];
    write(ctx, "bound", at, top + 1, map.theme.muted, `10px ${map.theme.font}`, side, "top", map.theme.surface);
  }
}

// Continue a path along what changes over time, given as a number after each step.
export function traceSteps(/** @type {Canvas2D} */ ctx, values, x, y) {
  values.forEach((value, step) => {
    if (step && value === values[step - 1]) return;
    if (step) ctx.lineTo(x(step), y(values[step - 1]));
    ctx.lineTo(x(step), y(value));
  });
  ctx.lineTo(x(values.length - 1), y(values.at(-1)));
}

// Where an axis of so many steps and pixels has numbers: [{step, text}].
export function timeMarks(/** @type {World} */ world, steps, width) {
  const unit = world.isTimed ? world.stepSeconds : 1;
  const length = steps * unit;
  const every = SPACINGS.find((spacing) => (spacing / length) * width >= MARKS_APART) ?? Math.max(1, length);
  const marks = [];
  for (let mark = 0; mark <= length + 1e-9; mark += every) {
    marks.push({ step: mark / unit, text: Number(mark.toFixed(2)) + world.secondsUnit });
  }
  return marks;
}
