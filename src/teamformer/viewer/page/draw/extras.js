// What can be switched on: lines to assignments, trails, the task order; and the selection.

import { isFlying } from "../record/mission.js";
import { orderAt, robotsWith, tasksNeeding } from "../record/scene.js";
import { NOBODY, placeOf } from "../record/state.js";
import { wayTo } from "../record/ways.js";
import { ringColour } from "./palette.js";
import { outlineDisc, robotSpot, shorten, teamSpot, tracedSquare } from "./shapes.js";
import { taskBox } from "./tasks.js";

const TRAIL_STEPS = 12;

// Only the selected team's line when the lines are off.
export function drawAssignments(/** @type {View} */ view) {
  const { ctx, scene, options, selectedTeam, selection } = view;
  ctx.lineWidth = 1.5;
  ctx.setLineDash([5, 4]);
  for (const team of scene.teams.values()) {
    if (team.assigned === NOBODY) continue;
    const isChosen = team === selectedTeam || team.assigned === selection.task;
    if (!options.lines && !isChosen) continue;
    ctx.globalAlpha = isChosen ? 1 : 0.55;
    drawAssignment(view, team);
  }
  ctx.setLineDash([]);
  ctx.globalAlpha = 1;
}

function drawAssignment(/** @type {View} */ view, /** @type {Team} */ team) {
  const { ctx } = view;
  const from = teamSpot(view, team);
  const { at, isUp } = view.sites[team.assigned];
  const [right, down] = [view.camera.x(at[0]), view.camera.y(at[1])];
  const to = isUp ? { x: right, y: down, half: 0.3 * view.camera.cell } : taskBox(view, team.assigned);
  if (Math.hypot(to.x - from.x, to.y - from.y) < from.r + to.half + 4) return;
  const { world } = view.mission;
  const way = wayTo(world, [team.x, team.y], at, isFlying(view.mission, team));
  const corners = way.slice(1, -1).map(([x, y]) => ({ x: view.camera.x(x), y: view.camera.y(y) }));
  const points = [from, ...corners, to];
  points[points.length - 1] = shorten(to, points.at(-2), to.half + 2);
  points[0] = shorten(from, points[1], from.r);
  ctx.strokeStyle = ringColour(team, view.isDark, view.options.rings);
  ctx.beginPath();
  for (const { x, y } of points) ctx.lineTo(x, y);
  ctx.stroke();
}

export function drawTrails(/** @type {View} */ view) {
  const { ctx, history, scene, camera, blended } = view;
  ctx.lineWidth = Math.max(1.5, Math.min(4, camera.cell * 0.09));
  ctx.lineJoin = "round";
  ctx.globalAlpha = 0.35;
  for (const team of scene.teams.values()) {
    const robot = team.slot;
    ctx.beginPath();
    ctx.moveTo(camera.x(blended.x[robot]), camera.y(blended.y[robot]));
    for (let back = 0; back <= Math.min(TRAIL_STEPS, scene.step); back++) {
      const { x, y } = placeOf(history.at(scene.step - back), robot);
      ctx.lineTo(camera.x(x), camera.y(y));
    }
    ctx.strokeStyle = ringColour(team, view.isDark, view.options.rings);
    ctx.stroke();
  }
  ctx.globalAlpha = 1;
}

// The order in which everybody would visit the open tasks.
export function drawOrder(/** @type {View} */ view) {
  const { ctx, camera, sites, theme } = view;
  const tasks = orderAt(view.history, view.scene.step);
  ctx.beginPath();
  for (const task of tasks) {
    const [x, y] = sites[task].at;
    ctx.lineTo(camera.x(x), camera.y(y));
  }
  ctx.strokeStyle = theme.muted;
  ctx.globalAlpha = 0.6;
  ctx.lineWidth = 1.5;
  ctx.setLineDash([1.5, 4]);
  ctx.lineCap = "round";
  ctx.stroke();
  ctx.lineCap = "butt";
  ctx.setLineDash([]);
  ctx.globalAlpha = 1;
}

// Who heard whom: each message is the half of the way that is its sender's, so that a link which
// works one way only looks like half a line. Heartbeats are faint, plans and facts are not.
export function drawMessages(/** @type {View} */ view) {
  const { ctx, history, scene, theme } = view;
  for (const [sender, receiver, what] of history.record.steps[scene.step - 1]?.heard ?? []) {
    const [from, to] = [robotSpot(view, sender), robotSpot(view, receiver)];
    ctx.globalAlpha = what === "beat" ? 0.25 : 0.9;
    ctx.strokeStyle = what === "beat" ? theme.muted : theme.accent;
    ctx.lineWidth = what === "beat" ? 1 : 2;
    ctx.beginPath();
    ctx.moveTo(from.x, from.y);
    ctx.lineTo((from.x + to.x) / 2, (from.y + to.y) / 2);
    ctx.stroke();
  }
  ctx.globalAlpha = 1;
}

export function drawSelection(/** @type {View} */ view) {
  const { ctx, theme, selection, selectedTeam, mission } = view;
  ctx.strokeStyle = theme.accent;
  ctx.lineWidth = 2;
  if (selection.task !== undefined) outlineTask(view, selection.task);
  if (selection.cap !== undefined) outlineCapability(view, selection.cap);
  if (selection.place) outlinePlace(view, selection.place);
  if (!selectedTeam) return;
  const { x, y, r } = teamSpot(view, selectedTeam);
  outlineDisc(ctx, x, y, r + 4);
  if (mission.sensingRadius < Infinity) drawSensing(view, x, y);
}

function outlineTask(/** @type {View} */ view, task) {
  const { x, y, half } = taskBox(view, task);
  tracedSquare(view.ctx, x, y, half + 5);
  view.ctx.stroke();
}

// A place where something may be added.
function outlinePlace(/** @type {View} */ { ctx, camera }, [x, y]) {
  const half = Math.max(6, 0.44 * camera.cell);
  ctx.setLineDash([4, 3]);
  ctx.strokeRect(camera.x(x) - half, camera.y(y) - half, 2 * half, 2 * half);
  ctx.setLineDash([]);
}

// Who brings a capability and what still needs it.
function outlineCapability(/** @type {View} */ view, cap) {
  const { history, scene } = view;
  for (const robot of robotsWith(history, cap, scene.step)) {
    const { x, y, r } = robotSpot(view, robot);
    outlineDisc(view.ctx, x, y, r + 2);
  }
  for (const task of tasksNeeding(history, cap, scene.step)) outlineTask(view, task);
}

function drawSensing(/** @type {View} */ { ctx, mission, camera }, x, y) {
  ctx.globalAlpha = 0.4;
  ctx.lineWidth = 1;
  ctx.setLineDash([3, 3]);
  outlineDisc(ctx, x, y, mission.sensingRadius * camera.cell);
  ctx.setLineDash([]);
  ctx.globalAlpha = 1;
}
