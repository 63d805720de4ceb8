// What several drawings need: views, spots on the screen, plain shapes.

import { between } from "./placing.js";

export function penOf(/** @type {HTMLCanvasElement} */ canvas) {
  return /** @type {Canvas2D} */ (canvas.getContext("2d"));
}

// A property that is worked out once, when it is asked for first.
export function lazily(object, key, make) {
  const get = () => {
    const value = make();
    Object.defineProperty(object, key, { value });
    return value;
  };
  Object.defineProperty(object, key, { get, configurable: true });
}

// The same view, drawn on another canvas.
export function onto(/** @type {View} */ view, /** @type {Canvas2D} */ ctx) {
  return Object.create(view, { ctx: { value: ctx } });
}

export function isOnScreen({ width, height }, x, y, reach) {
  return x > -reach && y > -reach && x < width + reach && y < height + reach;
}

export function cornerOf(half) {
  return Math.min(half * 0.35, 9);
}

export function tracedSquare(/** @type {Canvas2D} */ ctx, x, y, half) {
  ctx.beginPath();
  ctx.roundRect(x - half, y - half, 2 * half, 2 * half, cornerOf(half));
}

// Stroke what is traced; dashes, ends and strength hold for this stroke only.
export function strokeAs(/** @type {Canvas2D} */ ctx, colour, width, { alpha = 1, dash = /** @type {number[]} */ ([]), offset = 0, cap = "butt" } = {}) {
  const { globalAlpha } = ctx;
  Object.assign(ctx, { strokeStyle: colour, lineWidth: width, globalAlpha: globalAlpha * alpha, lineDashOffset: -offset, lineCap: cap });
  ctx.setLineDash(dash);
  ctx.stroke();
  ctx.setLineDash([]);
  Object.assign(ctx, { globalAlpha, lineDashOffset: 0, lineCap: "butt" });
}

// Fill what is traced, so strongly.
export function fillAs(/** @type {Canvas2D} */ ctx, colour, alpha = 1) {
  const { globalAlpha } = ctx;
  Object.assign(ctx, { fillStyle: colour, globalAlpha: globalAlpha * alpha });
  ctx.fill();
  ctx.globalAlpha = globalAlpha;
}

// Trace a line through points of the screen.
export function traceLine(/** @type {Canvas2D} */ ctx, /** @type {{x: number, y: number}[]} */ points) {
  ctx.beginPath();
  for (const { x, y } of points) ctx.lineTo(x, y);
}

// Write a text at a pixel, by default with that in its middle; `halo` is the colour of what parts it from its ground.
export function write(/** @type {Canvas2D} */ ctx, text, x, y, colour, font, align = "center", baseline = "middle", halo = "") {
  Object.assign(ctx, { fillStyle: colour, font, textAlign: align, textBaseline: baseline });
  if (halo) Object.assign(ctx, { lineWidth: 3, lineJoin: "round", strokeStyle: halo }).strokeText(text, x, y);
  ctx.fillText(text, x, y);
}

export function drawCross(/** @type {View} */ { ctx }, { x, y }, reach, colour) {
  ctx.beginPath();
  ctx.moveTo(x - reach, y - reach);
  ctx.lineTo(x + reach, y + reach);
  ctx.moveTo(x + reach, y - reach);
  ctx.lineTo(x - reach, y + reach);
  strokeAs(ctx, colour, Math.max(1.5, reach * 0.28));
}

// Where a robot is on the screen, in pixels.
export function robotSpot(/** @type {View} */ { camera, blended }, robot) {
  return {
    x: camera.x(blended.x[robot]),
    y: camera.y(blended.y[robot]),
    r: blended.r[robot] * camera.cell,
  };
}

export function tracedDisc(/** @type {Canvas2D} */ ctx, x, y, r) {
  ctx.beginPath();
  ctx.arc(x, y, r, 0, 2 * Math.PI);
}

export function drawDisc(/** @type {Canvas2D} */ ctx, x, y, r, colour) {
  tracedDisc(ctx, x, y, r);
  fillAs(ctx, colour);
}

// A team's circle on the screen: the middle of its robots, and how far they reach.
export function teamSpot(/** @type {View} */ view, /** @type {{robots: number[]}} */ team) {
  const spots = team.robots.map((robot) => robotSpot(view, robot));
  const x = spots.reduce((sum, spot) => sum + spot.x, 0) / spots.length;
  const y = spots.reduce((sum, spot) => sum + spot.y, 0) / spots.length;
  return { x, y, r: Math.max(...spots.map((s) => Math.hypot(s.x - x, s.y - y) + s.r)) };
}

// The point so far from one towards another, at most halfway.
export function shorten(one, other, length) {
  const apart = Math.hypot(other.x - one.x, other.y - one.y);
  const part = apart ? Math.min(0.5, length / apart) : 0;
  return { x: between(one.x, other.x, part), y: between(one.y, other.y, part) };
}

export function outlineDisc(/** @type {Canvas2D} */ ctx, x, y, r) {
  tracedDisc(ctx, x, y, r);
  ctx.stroke();
}
