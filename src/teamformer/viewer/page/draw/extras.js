// What can be switched on: lines to assignments, trails, the task order; and the selection.

import { isFlying } from "../record/mission.js";
import { orderAt, robotsWith, tasksNeeding } from "../record/scene.js";
import { NOBODY, placeOf } from "../record/state.js";
import { wayTo } from "../record/ways.js";
import { ringColour } from "./palette.js";
import { outlineDisc, robotSpot, shorten, strokeAs, teamSpot, tracedDisc, tracedSquare, traceLine } from "./shapes.js";
import { taskBox } from "./tasks.js";

const TRAIL_STEPS = 12;

// Only the selected team's line when the lines are off.
export function drawAssignments(/** @type {View} */ view) {
  const { scene, options, selectedTeam, selection } = view;
  for (const team of scene.teams.values()) {
    if (team.assigned === NOBODY) continue;
    const isChosen = team === selectedTeam || team.assigned === selection.task;
    if (options.lines || isChosen) drawAssignment(view, team, isChosen ? 1 : 0.55);
  }
}

function drawAssignment(/** @type {View} */ view, /** @type {Team} */ team, alpha) {
  const { ctx } = view;
  const from = teamSpot(view, team);
  const { at, isUp } = view.sites[team.assigned];
  const [right, down] = [view.camera.x(at[0]), view.camera.y(at[1])];
  const to = isUp ? { x: right, y: down, half: 0.3 * view.camera.cell } : taskBox(view, team.assigned);
  if (Math.hypot(to.x - from.x, to.y - from.y) < from.r + to.half + 4) return;
  const { world } = view.mission;
  const way = team.ahead ? [[team.x, team.y], ...team.ahead.places] : wayTo(world, [team.x, team.y], at, isFlying(view.mission, team));
  const corners = way.slice(1, -1).map(([x, y]) => ({ x: view.camera.x(x), y: view.camera.y(y) }));
  const points = [from, ...corners, to];
  points[points.length - 1] = shorten(to, points.at(-2), to.half + 2);
  points[0] = shorten(from, points[1], from.r);
  traceLine(ctx, points);
  strokeAs(ctx, ringColour(team, view.isDark, view.options.rings), 1.5, { dash: [5, 4], alpha });
}

export function drawTrails(/** @type {View} */ view) {
  const { ctx, history, scene, camera, blended } = view;
  const width = Math.max(1.5, Math.min(4, camera.cell * 0.09));
  ctx.lineJoin = "round";
  for (const team of scene.teams.values()) {
    const robot = team.slot;
    const places = [{ x: blended.x[robot], y: blended.y[robot] }];
    for (let back = 0; back <= Math.min(history.trail ?? TRAIL_STEPS, scene.step); back++) places.push(placeOf(history.at(scene.step - back), robot));
    traceLine(ctx, places.map(({ x, y }) => ({ x: camera.x(x), y: camera.y(y) })));
    strokeAs(ctx, ringColour(team, view.isDark, view.options.rings), width, { alpha: 0.35 });
  }
}

// The order in which everybody would visit the open tasks.
export function drawOrder(/** @type {View} */ view) {
  const { ctx, camera, sites, theme } = view;
  const places = orderAt(view.history, view.scene.step).map((task) => sites[task].at);
  traceLine(ctx, places.map(([x, y]) => ({ x: camera.x(x), y: camera.y(y) })));
  strokeAs(ctx, theme.muted, 1.5, { alpha: 0.6, dash: [1.5, 4], cap: "round" });
}

// Who heard whom: each message is the half of the way that is its sender's, so that a link which
// works one way only looks like half a line. Heartbeats are faint, plans and facts are not.
export function drawMessages(/** @type {View} */ view) {
  const { ctx, history, scene, theme } = view;
  for (const [sender, receiver, what] of history.record.steps[scene.step - 1]?.heard ?? []) {
    const [from, to] = [robotSpot(view, sender), robotSpot(view, receiver)];
    traceLine(ctx, [from, { x: (from.x + to.x) / 2, y: (from.y + to.y) / 2 }]);
    if (what === "beat") strokeAs(ctx, theme.muted, 1, { alpha: 0.25 });
    else strokeAs(ctx, theme.accent, 2, { alpha: 0.9 });
  }
}

export function drawSelection(/** @type {View} */ view) {
  const { ctx, theme, selection, selectedTeam, mission, history } = view;
  ctx.strokeStyle = theme.accent;
  ctx.lineWidth = 2;
  if (selection.task !== undefined) outlineTask(view, selection.task);
  if (selection.cap !== undefined) outlineCapability(view, selection.cap);
  if (selection.place) outlinePlace(view, selection.place);
  if (!selectedTeam) return;
  const { x, y, r } = teamSpot(view, selectedTeam);
  outlineDisc(ctx, x, y, r + 4);
  if (mission.sensingRadius < Infinity && !history.isContinuous) drawSensing(view, x, y);
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

function drawSensing(/** @type {View} */ { ctx, mission, camera, theme }, x, y) {
  tracedDisc(ctx, x, y, mission.sensingRadius * camera.cell);
  strokeAs(ctx, theme.accent, 1, { alpha: 0.4, dash: [3, 3] });
}
