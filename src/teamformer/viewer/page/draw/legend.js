// What the colours of a crowd say: how dense robots lie, or what those of a group do.

import { ACTIVITIES } from "../panel/inspector.js";
import { plural } from "../record/lengths.js";
import { ACTIVITY_COLOURS, DENSE_SIDE, densityStrength } from "./groups.js";
import { strokeAs, tracedDisc, write } from "./shapes.js";
import { drawTaskDot } from "./tasks.js";

const LEGEND_ROW = 18; // pixels
const LEGEND_MARK = 20; // with the space before its text
const LEGEND_GAP = 14;

// Over the map, where robots are not drawn one by one; pictures have it too. Returns its pixels down
// that do not fit into what is free around a map that is fitted.
export function drawCrowdLegend(/** @type {View} */ view) {
  if (view.detail === "robots") return 0;
  const { ctx, theme } = view;
  ctx.font = `11px ${theme.font}`;
  const items = inRows(ctx, [...crowdItems(view), ...taskItems(view)], view.width - 20);
  const width = Math.max(...items.map(({ right }) => right));
  ctx.globalAlpha = 0.85;
  ctx.fillStyle = theme.paper;
  const height = (items.at(-1).row + 1) * LEGEND_ROW + 4;
  ctx.fillRect(6, 6, width + 8, height);
  for (const { text, draw, x, y } of items) {
    draw(x, y);
    ctx.globalAlpha = 1;
    write(ctx, text, x + LEGEND_MARK - 6, y + 0.5, theme.ink, ctx.font, "left");
  }
  view.legend = items;
  return Math.max(0, height - LEGEND_ROW);
}

// The items with the places of their marks: one after the other, a new row where there is no room.
function inRows(/** @type {Canvas2D} */ ctx, items, width) {
  let [left, row] = [0, 0];
  return items.map((item) => {
    const wide = LEGEND_MARK + ctx.measureText(item.text).width;
    if (left > 0 && left + wide > width) [left, row] = [0, row + 1];
    const placed = { ...item, row, right: left + wide, x: 16 + left, y: 8 + (row + 0.5) * LEGEND_ROW };
    left += wide + LEGEND_GAP;
    return placed;
  });
}

function crowdItems(/** @type {View} */ view) {
  return view.detail === "density" ? densityItems(view) : groupItems(view);
}

// One robot in a square, as many as anywhere, and what is between them.
function densityItems(/** @type {View} */ { ctx, theme, mostInSquare: most }) {
  const counts = [...new Set([1, Math.round(Math.sqrt(most)), most])];
  return counts.map((count) => ({
    text: `${plural(count, "robot")} in a square`,
    draw: (x, y) => {
      ctx.globalAlpha = densityStrength(count, most);
      ctx.fillStyle = theme.accent;
      ctx.fillRect(x - 4, y - 4, DENSE_SIDE - 1, DENSE_SIDE - 1);
    },
  }));
}

// Parts of the rings of groups; who serves and who has just done a task have one colour.
function groupItems(/** @type {View} */ { ctx, theme }) {
  return ["walks", "waits", "serves", "idle"].map((activity) => ({
    text: `robots ${ACTIVITIES[activity]}`,
    draw: (x, y) => {
      tracedDisc(ctx, x, y, 5);
      strokeAs(ctx, theme[ACTIVITY_COLOURS[activity]], 4);
    },
  }));
}

function taskItems(/** @type {View} */ view) {
  const words = { open: "open task", served: "served", done: "done" };
  return Object.entries(words).map(([standing, text]) => ({
    text,
    draw: (x, y) => drawTaskDot(view, null, { x, y, half: 4 }, standing),
  }));
}
