// A row of the Gantt view: a robot's name, its bars, a mark for each task that it did, its idle share.

import { taskColour } from "../draw/palette.js";
import { fillAs, strokeAs, traceLine, write } from "../draw/shapes.js";
import { describeMoment, percent } from "../record/lengths.js";
import { NOBODY } from "../record/state.js";
import { IDLE, LOST, OFF, WAITING, chargeAt } from "../record/told.js";
import { describeWhen, robotName, taskName } from "../record/words.js";
import { NAME_WIDTH, SHARE_WIDTH } from "./chart_sizes.js";
import { isOnPath } from "./critical_path.js";

const NAMED_FROM = 34; // pixels of a bar
const PARTED_FROM = 16; // pixels of a bar
const MARK = 4; // pixels from the middle of a mark to its edge
const DARK = "#1b1400"; // ink on the colour of waiting, in both themes

export const PHASE_COLOURS = {
  walking: "accent",
  waiting: "wait",
  forming: "form",
  serving: "good",
  loading: "load",
  carrying: "carry",
  unloading: "load",
  idle: "line",
  charging: "task",
  queueing: "wait",
  lost: "bad",
  off: "lost",
};

// How strong a phase is drawn in the colour of its task.
export const STRENGTHS = { walking: 0.5, waiting: 0.25, forming: 0.75, serving: 1, loading: 0.85, carrying: 1, unloading: 0.85, idle: 1, lost: 0.25, off: 0.35, charging: 0.85, queueing: 0.6 };

// What bars may be coloured by.
export const BARS = { phase: "What they do", task: "Tasks" };

export function drawBarsOfRow(/** @type {Canvas2D} */ ctx, /** @type {Gantt} */ gantt, robot, top, row) {
  const { from, to } = gantt.stepsInSight();
  const marks = marksOfRow(gantt, robot, row);
  const isWide = (run) => run && gantt.x(run.to) - gantt.x(run.from) >= PARTED_FROM;
  gantt.runsOf(robot).forEach((run, index, runs) => {
    const isParted = isWide(run) && isWide(runs[index + 1]);
    if (run.to >= from && run.from <= to) drawBar(ctx, gantt, run, marks, top, row, isParted ? 0.6 : 0);
  });
  drawMarks(ctx, gantt, marks, top, row);
}

// `parted` is the space before the next bar: between narrow bars there is none, or they would be
// mostly space.
function drawBar(/** @type {Canvas2D} */ ctx, /** @type {Gantt} */ gantt, run, marks, top, row, parted) {
  const gap = row > 10 ? 2 : 1;
  const [left, right] = [gantt.x(run.from), gantt.x(run.to)];
  const { colour, strength, ink } = paintOf(gantt.app, run);
  ctx.fillStyle = colour;
  ctx.globalAlpha = strength;
  ctx.fillRect(left, top + gap / 2, Math.max(0.75, right - left - parted), row - gap);
  ctx.globalAlpha = 1;
  nameBar(ctx, gantt, run, marks, top + row / 2, ink);
}

// The colour of a bar, how strong it is, and the ink of its name.
function paintOf(/** @type {Shown} */ { map, options }, /** @type {Run} */ { phase, task }) {
  const { theme, isDark } = map;
  if (options.bars === "task" && task !== NOBODY && phase !== LOST && phase !== OFF) {
    const strength = STRENGTHS[phase];
    return { colour: taskColour(task, isDark), strength, ink: strength > 0.6 ? theme.surface : theme.ink };
  }
  const strength = phase === LOST || phase === OFF ? STRENGTHS[phase] : 1;
  return { colour: theme[PHASE_COLOURS[phase]], strength, ink: phase === WAITING ? DARK : theme.surface };
}

// The task that a bar is about, where there is room between the marks of tasks done; it stays in sight
// with a part of its bar.
function nameBar(/** @type {Canvas2D} */ ctx, /** @type {Gantt} */ gantt, /** @type {Run} */ { phase, task, from, to }, marks, middle, ink) {
  if (task === NOBODY || phase === IDLE || phase === LOST || phase === OFF) return;
  const begin = Math.max(gantt.x(from), NAME_WIDTH);
  const over = marks.filter(({ left, right }) => left <= begin && right > begin);
  const left = Math.max(begin, ...over.map((mark) => mark.right - MARK));
  const end = Math.min(gantt.x(to), gantt.width - SHARE_WIDTH);
  const room = Math.min(end, ...marks.filter((mark) => mark.left > begin).map((mark) => mark.left)) - left;
  if (room <= NAMED_FROM) return;
  ctx.font = `11px ${gantt.app.map.theme.font}`;
  const text = clipped(ctx, taskName(gantt.app.history.mission, task), room - 12);
  write(ctx, text, left + 7, middle + 0.5, ink, ctx.font, "left");
}

// Where the robot had done tasks: [{task, x, left, right}]; marks of one step stand side by side.
function marksOfRow(/** @type {Gantt} */ gantt, robot, row) {
  const half = halfOfMark(row);
  let [last, beside] = [-1, 0];
  return (gantt.deeds?.[robot] ?? []).map(({ task, step }) => {
    beside = step === last ? beside + 1 : 0;
    last = step;
    const x = gantt.x(step) - beside * half * 1.6;
    return { task, x, left: x - half, right: x + half };
  });
}

function halfOfMark(row) {
  return Math.min(MARK, row * 0.32);
}

// A diamond in the task's colour for each task done.
function drawMarks(/** @type {Canvas2D} */ ctx, /** @type {Gantt} */ gantt, marks, top, row) {
  const { theme, isDark } = gantt.app.map;
  const [half, y] = [halfOfMark(row), top + row / 2];
  for (const { task, x } of marks) {
    traceLine(ctx, [{ x, y: y - half }, { x: x + half, y }, { x, y: y + half }, { x: x - half, y }]);
    ctx.closePath();
    strokeAs(ctx, theme.surface, row > 16 ? 1.5 : 0.75);
    fillAs(ctx, taskColour(task, isDark));
  }
}

// On a ground of their own, so that bars pass under them.
export function drawEndsOfRow(/** @type {Canvas2D} */ ctx, /** @type {Gantt} */ gantt, robot, top, row) {
  const { history, map, selection } = gantt.app;
  const { theme } = map;
  ctx.fillStyle = selection.robot === robot ? theme.soft : theme.ground;
  ctx.fillRect(0, top, NAME_WIDTH - 4, row);
  ctx.fillRect(gantt.width - SHARE_WIDTH, top, SHARE_WIDTH, row);
  ctx.font = `${Math.min(12, row - 1)}px ${theme.font}`;
  const name = clipped(ctx, robotName(history.mission, robot), NAME_WIDTH - 14);
  write(ctx, name, NAME_WIDTH - 8, top + row / 2, theme.ink, ctx.font, "right");
  write(ctx, percent(gantt.shareOf(robot, IDLE)), gantt.width - 10, top + row / 2, theme.muted, ctx.font, "right");
}

// What a robot did in a step, in words.
export function describeBar(/** @type {Gantt} */ gantt, robot, step) {
  const { history } = gantt.app;
  const { mission } = history;
  const run = gantt.runsOf(robot).find(({ from, to }) => from < step && step <= to);
  if (!run) return robotName(mission, robot);
  const about = run.task === NOBODY ? "" : `, ${taskName(mission, run.task)}`;
  const [from, to] = [run.from, run.to].map((it) => describeMoment(mission.world, it));
  const done = (gantt.deeds?.[robot] ?? []).filter((deed) => deed.step > run.from && deed.step <= run.to);
  const deeds = done.map(({ task, step: at }) => `${taskName(mission, task)} done ${describeWhen(mission.world, at)}`);
  const name = robotName(mission, robot);
  const charge = chargeAt(history, robot, step);
  if (charge !== null) deeds.push(`battery ${percent(charge)}`);
  if (isOnPath(history, robot, step)) deeds.push("on the critical path");
  return [`${name}: ${run.phase}${about}, ${from} to ${to}`, ...deeds].join("\n");
}

// A text cut so that it fits into so many pixels.
function clipped(/** @type {Canvas2D} */ ctx, text, width) {
  if (ctx.measureText(text).width <= width) return text;
  let end = text.length;
  while (end > 0 && ctx.measureText(`${text.slice(0, end)}…`).width > width) end--;
  return end > 1 ? `${text.slice(0, end)}…` : "";
}
