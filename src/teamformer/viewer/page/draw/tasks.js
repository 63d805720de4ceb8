// Tasks: a tinted square in the task's own colour, outlined in its requirements.

import { attemptOn } from "../panel/attempt.js";
import { piecesOf, sumCounts } from "../record/counts.js";
import { needsAt } from "../record/history.js";
import { cellKey } from "../record/mission.js";
import { standingOf } from "../record/scene.js";
import { serviceAfter } from "../record/told.js";
import { taskColour } from "./palette.js";
import { TASK_HALF, between, taskSquare } from "./placing.js";
import { cornerOf, drawCross, fillAs, isOnScreen, onto, penOf, shorten, strokeAs, teamSpot, tracedDisc, tracedSquare, traceLine, write } from "./shapes.js";

export function drawTasks(/** @type {View} */ view, tasks) {
  for (const task of tasks) attemptOn(view.ctx, "the tasks", () => drawTaskAsItStands(view, task));
}

function drawTaskAsItStands(/** @type {View} */ view, task) {
  const standing = standingOf(view.history, task, view.scene.step);
  const box = taskBox(view, task);
  if (!isOnScreen(view, box.x, box.y, box.half + 20)) return;
  if (isDot(view)) drawTaskDot(view, task, box, standing);
  else if (isUnchanging(view, task, standing)) drawTaskImage(view, task, box, standing);
  else drawTask(view, task, box, standing);
}

// The tasks that are there: those that stand still until the next step, and the others.
export function partTasks(/** @type {View} */ view) {
  /** @type {number[][]} */ const parts = [[], []];
  view.mission.tasks.forEach((_, task) => {
    const standing = standingOf(view.history, task, view.scene.step);
    if (standing === "hidden") return;
    const isStill = isDot(view) || isUnchanging(view, task, standing);
    parts[isStill ? 0 : 1].push(task);
  });
  return parts;
}

// In crowds tasks are small squares, and wherever they are dimmed.
function isDot(/** @type {View} */ { detail, options }) {
  return detail !== "robots" || options.dim;
}

function drawTask(/** @type {View} */ view, task, /** @type {Box} */ box, standing) {
  if (standing === "done") drawDoneTask(view, task, box);
  else if (standing === "cancelled") drawCancelledTask(view, box);
  else drawOpenTask(view, task, box, standing);
}

// A task with no robots around looks the same from moment to moment.
function isUnchanging(/** @type {View} */ { history, sites, scene, places, placesAfter }, task, standing) {
  if (sites[task].isUp) return false;
  const cell = cellKey(...sites[task].at);
  if (places.cells.has(cell) || placesAfter.cells.has(cell)) return false;
  return standing === "open" || standing === "cancelled" || (standing === "done" && scene.step >= history.doneAt[task] + FADE_STEPS);
}

// Such a task is drawn once and then copied: with a thousand tasks this is most of the work.
function drawTaskImage(/** @type {View} */ view, task, /** @type {Box} */ box, standing) {
  const { ctx, images, sharpness } = view;
  const key = `${task} ${standing}`;
  const reach = Math.ceil(box.half) + 4;
  const image = images.get(key) ?? taskImage(view, task, box.half, reach, standing);
  images.set(key, image);
  const left = Math.round((box.x - reach) * sharpness) / sharpness;
  const top = Math.round((box.y - reach) * sharpness) / sharpness;
  ctx.drawImage(image, left, top, 2 * reach, 2 * reach);
}

function taskImage(/** @type {View} */ view, task, half, reach, standing) {
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = Math.round(2 * reach * view.sharpness);
  const ctx = penOf(canvas);
  ctx.scale(view.sharpness, view.sharpness);
  drawTask(onto(view, ctx), task, { x: reach, y: reach, half }, standing);
  return canvas;
}

const FEW_TASKS = 40; // of so many each may be a little larger than its cell, so that letters fit
const ROOMY_CELL = 12; // pixels

// The square of a task in pixels.
export function taskBox(/** @type {View} */ view, task) {
  const { camera, sites, places, placesAfter, part, detail, mission } = view;
  const { cell } = camera;
  const { at, isUp } = sites[task];
  if (isUp) return loadBox(view, task);
  const [x, y] = [camera.x(at[0]), camera.y(at[1])];
  if (detail !== "robots") return { x, y, half: Math.max(1.5, 0.3 * cell) };
  const least = mission.tasks.length <= FEW_TASKS && cell >= ROOMY_CELL ? 8 : 6;
  const [from, to] = [places, placesAfter].map((known) => taskSquare(known, sites[task], task, cell, least));
  const pixels = (key) => between(from[key], to[key], part) * cell;
  return { x: x + pixels("right"), y: y + pixels("down"), half: pixels("half") };
}

// A load goes with the robots that carry it, and embraces them.
function loadBox(/** @type {View} */ view, task) {
  const { history, scene, camera } = view;
  const robots = serviceAfter(history, task, scene.step)?.robots ?? [];
  const { x, y, r } = teamSpot(view, { robots });
  return { x, y, half: Math.max(TASK_HALF * camera.cell, r + 3) };
}

// Where loads go that are not there yet: a dashed square, and a line to it.
export function drawDestinations(/** @type {View} */ view) {
  const { ctx, camera, history, mission, scene } = view;
  mission.tasks.forEach(({ to }, task) => {
    const standing = standingOf(history, task, scene.step);
    if (!to || ["hidden", "done", "cancelled"].includes(standing)) return;
    const goal = { x: camera.x(to[0]), y: camera.y(to[1]), half: 0.3 * camera.cell };
    const from = taskBox(view, task);
    const colour = taskColour(task, view.isDark);
    tracedSquare(ctx, goal.x, goal.y, goal.half);
    strokeAs(ctx, colour, 1.5, { alpha: 0.6, dash: [4, 3] });
    if (Math.hypot(from.x - goal.x, from.y - goal.y) <= from.half + goal.half) return;
    traceLine(ctx, [shorten(from, goal, from.half), shorten(goal, from, goal.half)]);
    strokeAs(ctx, colour, 1.5, { alpha: 0.3, dash: [4, 3] });
  });
}

// Robots stand in the middle of a task that has its place for itself.
function isCovered(/** @type {View} */ { places, sites }, task) {
  const { at, mates, isUp } = sites[task];
  if (isUp) return true;
  return mates.length === 1 && places.cells.has(cellKey(...at));
}

// Around where a task may be that nobody has found, a circle; the square is where it is believed.
// On roads there is none, as nothing lies around a place.
export function drawRegions(/** @type {View} */ view) {
  const { ctx, history, mission, scene, camera } = view;
  mission.tasks.forEach(({ around, within }, task) => {
    const isHidden = ["hidden", "cancelled"].includes(standingOf(history, task, scene.step));
    if (isHidden || history.foundAt[task] <= scene.step || mission.world.roads) return;
    tracedDisc(ctx, camera.x(around[0]), camera.y(around[1]), (within + 0.5) * camera.cell);
    fillAs(ctx, taskColour(task, view.isDark), 0.06);
    strokeAs(ctx, taskColour(task, view.isDark), 1, { alpha: 0.5, dash: [2, 4] });
  });
}

function drawOpenTask(/** @type {View} */ view, task, /** @type {Box} */ box, standing) {
  const { ctx } = view;
  tracedSquare(ctx, box.x, box.y, box.half);
  fillAs(ctx, taskColour(task, view.isDark), view.isDark ? 0.24 : 0.15);
  drawRequirements(view, task, box);
  drawOwnOutline(view, task, box);
  if (standing === "served") drawProgress(view, task, box);
  if (standing === "blocked") drawCross(view, box, box.half * 0.5, view.theme.bad);
  else if (!isCovered(view, task)) drawNeeds(view, task, box);
}

function squareLength(half) {
  return 8 * (half - cornerOf(half)) + 2 * Math.PI * cornerOf(half);
}

function outlineWidth(half) {
  return Math.max(1.5, Math.min(5, half * 0.17));
}

// One piece of the outline for each count of each requirement, in the capability's colour; one for
// all of what is measured, such as kilograms.
function drawRequirements(/** @type {View} */ view, task, { x, y, half }) {
  const { ctx } = view;
  const open = hiddenNeeds(view, task);
  const needs = open.length ? view.mission.tasks[task].sure : needsAt(view.history, task, view.scene.step);
  const width = outlineWidth(half);
  const inner = half - width * 0.5;
  const length = squareLength(inner);
  /** @type {Counts} */
  const pieces = needs.map(([cap, count]) => [cap, piecesOf(count)]);
  const piece = length / (sumCounts(pieces) + open.length);
  const gap = Math.min(2, piece * 0.2);
  const dash = [piece - gap, length - piece + gap];
  tracedSquare(ctx, x, y, inner);
  let offset = 0;
  for (const [cap, count] of pieces) {
    for (let n = 0; n < count; n++, offset += piece) strokeAs(ctx, view.colours[cap].fill, width, { dash, offset });
  }
  for (const [cap] of open) {
    strokeAs(ctx, view.colours[cap].fill, width, { dash, offset, alpha: UNSURE });
    offset += piece;
  }
}

const UNSURE = 0.35; // how strong is drawn what may be needed

// What may be needed while nobody knows it.
function hiddenNeeds(/** @type {View} */ view, task) {
  const isHidden = view.history.shownAt[task] > view.scene.step;
  return isHidden ? view.mission.tasks[task].mayNeed : [];
}

// The thin line in the task's own colour.
function drawOwnOutline(/** @type {View} */ view, task, { x, y, half }) {
  const { ctx } = view;
  tracedSquare(ctx, x, y, half + 1);
  strokeAs(ctx, taskColour(task, view.isDark), half > 10 ? 2 : 1);
}

// How much of a service is made, as a thick line around the outline.
function drawProgress(/** @type {View} */ view, task, { x, y, half }) {
  const { ctx } = view;
  const { duration } = view.mission.tasks[task];
  if (view.sites[task].isUp || !duration) return;
  const service = serviceAfter(view.history, task, view.scene.step);
  if (!service) return;
  const made = view.scene.step + view.part - service.from;
  const outer = half + 4;
  const length = squareLength(outer);
  tracedSquare(ctx, x, y, outer);
  strokeAs(ctx, taskColour(task, view.isDark), 5, { dash: [(length * made) / duration, length] });
}

const SMALLEST_TEXT = 7; // pixels
const MOST_NAMED = 9; // kinds of needs

// What is needed, each kind with its amount, where there is room; else how many kinds. The list is
// in the panel and under the pointer.
function drawNeeds(/** @type {View} */ view, task, { x, y, half }) {
  const { ctx, theme } = view;
  const fit = needsThatFit(view, task, half);
  if (!fit) return;
  const { lines, size } = fit;
  lines.forEach((line, index) => {
    write(ctx, line, x, y + (index - (lines.length - 1) / 2) * size * 1.15 + size * 0.05, theme.ink, `600 ${size}px ${theme.font}`);
  });
}

// Lines of text about a task's needs and the size at which they fit into its square; null if none do.
export function needsThatFit(/** @type {View} */ { ctx, theme, mission, labels, history, scene }, task, half) {
  const isOpen = history.shownAt[task] > scene.step;
  const needs = isOpen ? mission.tasks[task].sure : needsAt(history, task, scene.step);
  const mark = isOpen ? " ?" : "";
  for (const lines of [needsLines(mission, labels, needs), kindsLines(needs)]) {
    if (!lines) continue;
    const marked = [...lines.slice(0, -1), lines.at(-1) + mark];
    const roomy = (half * 1.45) / Math.max(2.4, 1.15 * marked.length);
    const tight = (half * 1.45) / Math.max(1.6, 1.15 * marked.length); // in a small square
    const wanted = Math.min(15, Math.max(roomy, Math.min(tight, SMALLEST_TEXT + 1)));
    ctx.font = `600 ${wanted}px ${theme.font}`;
    const widest = Math.max(...marked.map((line) => ctx.measureText(line).width));
    const size = wanted * Math.min(1, (half * 1.5) / widest);
    if (size >= SMALLEST_TEXT) return { lines: marked, size };
  }
  return null;
}

// Labels with amounts, such as `30L S`, in about as many lines as columns; null if there are too many.
function needsLines(/** @type {Mission} */ { capabilities }, labels, /** @type {Counts} */ needs) {
  if (!needs.length || needs.length > MOST_NAMED) return null;
  const parts = needs.map(([cap, count]) => {
    const label = needLabel(capabilities[cap], labels[cap]);
    return count === 1 ? label : `${count}${label}`;
  });
  const columns = parts.length < 3 ? 2 : Math.ceil(Math.sqrt(parts.length));
  const rows = Array.from({ length: Math.ceil(parts.length / columns) }, (_, row) => row);
  return rows.map((row) => parts.slice(row * columns, (row + 1) * columns).join(" "));
}

// A label that is a number looks like an amount: it takes the first letter of its name along.
function needLabel(name, label) {
  return /^\d/.test(label) ? `${/\p{L}/u.exec(name)?.[0] ?? "#"}${label}` : label;
}

function kindsLines(/** @type {Counts} */ needs) {
  return needs.length > 1 ? [String(needs.length), "kinds"] : null;
}

const FADE_STEPS = 3;

function drawDoneTask(/** @type {View} */ view, task, /** @type {Box} */ box) {
  const { ctx } = view;
  const since = view.scene.step + view.part - view.history.doneAt[task];
  const strength = between(1, 0.34, Math.min(1, since / FADE_STEPS));
  const colour = taskColour(task, view.isDark);
  tracedSquare(ctx, box.x, box.y, box.half);
  strokeAs(ctx, colour, box.half > 10 ? 2 : 1, { alpha: strength });
  fillAs(ctx, colour, strength * 0.2);
  if (!isCovered(view, task)) drawTick(view, box, colour, Math.min(1, strength + 0.25));
}

// A task that was called off: an empty square, struck through.
function drawCancelledTask(/** @type {View} */ { ctx, theme }, { x, y, half }) {
  tracedSquare(ctx, x, y, half);
  ctx.moveTo(x - half * 0.7, y + half * 0.7);
  ctx.lineTo(x + half * 0.7, y - half * 0.7);
  strokeAs(ctx, theme.lost, half > 10 ? 2 : 1, { alpha: 0.7 });
}

function drawTick(/** @type {View} */ { ctx }, { x, y, half }, colour, alpha) {
  const corners = [[-0.42, 0.02], [-0.1, 0.34], [0.44, -0.32]];
  traceLine(ctx, corners.map(([right, down]) => ({ x: x + half * right, y: y + half * down })));
  ctx.lineJoin = "round";
  strokeAs(ctx, colour, Math.max(1.5, half * 0.15), { alpha, cap: "round" });
  ctx.lineJoin = "miter";
}

const DIMMED = 0.35; // how strong dimmed tasks are drawn

// A task as a small square: full while it is open, pale once it is over; dimmed, paler still.
export function drawTaskDot(/** @type {View} */ view, task, { x, y, half }, standing) {
  const { ctx, theme, options } = view;
  const isPast = standing === "done" || standing === "cancelled";
  ctx.globalAlpha = (isPast ? 0.3 : view.detail === "density" ? 0.5 : 0.85) * (options.dim ? DIMMED : 1);
  ctx.fillStyle = isPast ? theme.lost : standing === "served" ? theme.good : theme.task;
  ctx.fillRect(x - half, y - half, 2 * half, 2 * half);
  ctx.globalAlpha = 1;
}
