// Robots and teams: inner disc = capability, outer ring = team, in the task's colour once met.

import { piecesOf, sumCounts } from "../record/counts.js";
import { robotsLostAt } from "../record/history.js";
import { ringColour } from "./palette.js";
import { drawCross, drawDisc, fillAs, isOnScreen, robotSpot, strokeAs, tracedDisc, write } from "./shapes.js";

export function drawTeam(/** @type {View} */ view, /** @type {Team} */ team) {
  const ring = ringColour(team, view.isDark, view.options.rings);
  if (team.robots.length > 1) drawUnion(view, team, ring);
  for (const robot of team.robots) drawRobot(view, robot, ring, team.isMet);
}

// The robots of one team lie on a common ground in its colour.
function drawUnion(/** @type {View} */ view, /** @type {Team} */ team, colour) {
  const { ctx } = view;
  ctx.beginPath();
  for (const robot of team.robots) {
    const { x, y, r } = robotSpot(view, robot);
    ctx.moveTo(x + r * 1.35, y);
    ctx.arc(x, y, r * 1.35, 0, 2 * Math.PI);
  }
  fillAs(ctx, colour, team.isMet ? 0.45 : 0.28);
}

function drawRobot(/** @type {View} */ view, robot, ring, isMet) {
  const { ctx, theme } = view;
  const { x, y, r } = robotSpot(view, robot);
  if (!isOnScreen(view, x, y, r)) return;
  if (view.mission.robots[robot].flies) drawRotors(view, x, y, r, ring);
  drawDisc(ctx, x, y, r, ring);
  const inner = r * (isMet && r >= 5 ? 0.6 : 0.72);
  if (r >= 5) drawDisc(ctx, x, y, inner + Math.min(1.5, r * 0.12), theme.ground);
  drawCapabilities(view, robot, x, y, inner);
}

// Four rotors around a robot that flies, on arms that cross under it.
function drawRotors(/** @type {View} */ { ctx, theme }, x, y, r, colour) {
  const width = Math.max(1, r * 0.16);
  for (const [right, up] of [[1, 1], [1, -1], [-1, 1], [-1, -1]]) {
    tracedDisc(ctx, x + right * r * 0.95, y + up * r * 0.95, Math.max(1.5, r * 0.42));
    fillAs(ctx, theme.ground);
    strokeAs(ctx, colour, width);
  }
}

// One sector for each capability, as wide as its count, if that is none of what is measured.
function drawCapabilities(/** @type {View} */ view, robot, x, y, r) {
  const { ctx, colours } = view;
  const { can } = view.mission.robots[robot];
  if (can.length === 1) {
    drawDisc(ctx, x, y, r, colours[can[0][0]].fill);
    drawLabel(view, can[0][0], x, y, r);
    return;
  }
  const total = sumCounts(can.map(([cap, count]) => [cap, piecesOf(count)]));
  let start = -Math.PI / 2;
  for (const [cap, count] of can) {
    const end = start + (2 * Math.PI * piecesOf(count)) / total;
    ctx.beginPath();
    ctx.moveTo(x, y);
    ctx.arc(x, y, r, start, end);
    fillAs(ctx, colours[cap].fill);
    const middle = (start + end) / 2;
    drawLabel(view, cap, x + Math.cos(middle) * r * 0.55, y + Math.sin(middle) * r * 0.55, r * 0.55);
    start = end;
  }
}

function drawLabel(/** @type {View} */ { ctx, labels, colours, theme }, cap, x, y, r) {
  const label = labels[cap];
  const size = Math.min(15, r * (label.length > 2 ? 0.85 : label.length > 1 ? 1.05 : 1.3));
  if (size < 6.5) return;
  write(ctx, label, x, y + size * 0.06, colours[cap].ink, `600 ${size}px ${theme.font}`);
}

export function drawLostRobots(/** @type {View} */ view) {
  const { ctx, theme, history, scene } = view;
  for (const robot of robotsLostAt(history, scene.step)) {
    const { x, y, r } = robotSpot(view, robot);
    ctx.globalAlpha = 0.8;
    drawDisc(ctx, x, y, r * 0.86, theme.lost);
    drawCross(view, { x, y }, r * 0.42, theme.ground);
    ctx.globalAlpha = 1;
  }
}
