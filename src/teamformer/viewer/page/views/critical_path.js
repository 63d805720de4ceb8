// The critical path in the Gantt view: frames around what the end hangs on, joined from row to row.

import { NOBODY } from "../record/state.js";
import { AXIS_HEIGHT, NAME_WIDTH, SHARE_WIDTH } from "./chart_sizes.js";

const FRAME = 2; // pixels

export function drawCriticalPath(/** @type {Canvas2D} */ ctx, /** @type {Gantt} */ gantt) {
  const { app } = gantt;
  const { path } = app.history.told;
  if (!path.length) return;
  ctx.save();
  ctx.beginPath();
  ctx.rect(NAME_WIDTH - 2, AXIS_HEIGHT - 3, gantt.width - NAME_WIDTH - SHARE_WIDTH, gantt.height);
  ctx.clip();
  ctx.strokeStyle = app.map.theme.ink;
  ctx.lineWidth = FRAME;
  const runs = runsOfRobots(path);
  runs.forEach((run, place) => {
    frameRun(ctx, gantt, run);
    if (runs[place + 1]) joinRows(ctx, gantt, run, runs[place + 1]);
  });
  ctx.restore();
}

// From when to when each robot in turn is what the end hangs on.
function runsOfRobots(path) {
  const runs = [];
  for (const { from, to, robot } of path) {
    if (runs.at(-1)?.robot === robot) runs.at(-1).to = to;
    else runs.push({ from, to, robot });
  }
  return runs;
}

// A frame around bars; along the axis where no robot is what the end hangs on.
function frameRun(/** @type {Canvas2D} */ ctx, /** @type {Gantt} */ gantt, /** @type {Stretch} */ { from, to, robot }) {
  const [left, right] = [gantt.x(from), gantt.x(to)];
  if (robot === NOBODY) {
    ctx.strokeRect(left, AXIS_HEIGHT - 1, right - left, 0);
    return;
  }
  const row = gantt.rowHeight();
  ctx.strokeRect(left + 1, rowTop(gantt, robot) + 1, Math.max(1, right - left - 2), row - 2);
}

function joinRows(/** @type {Canvas2D} */ ctx, /** @type {Gantt} */ gantt, { to, robot }, next) {
  const x = gantt.x(to);
  ctx.beginPath();
  ctx.moveTo(x, rowMiddle(gantt, robot));
  ctx.lineTo(x, rowMiddle(gantt, next.robot));
  ctx.stroke();
}

function rowTop(/** @type {Gantt} */ gantt, robot) {
  return AXIS_HEIGHT + robot * gantt.rowHeight() - gantt.box.scrollTop;
}

function rowMiddle(/** @type {Gantt} */ gantt, robot) {
  return robot === NOBODY ? AXIS_HEIGHT - 1 : rowTop(gantt, robot) + gantt.rowHeight() / 2;
}

export function isOnPath(/** @type {TrialHistory} */ { told }, robot, step) {
  return told.path.some((it) => it.robot === robot && it.from < step && step <= it.to);
}
