// Zones: where they are, how many services go on in each, and for how many there is room.

import { CARRYING, UNLOADING, serviceAfter } from "../record/told.js";
import { isOverTask } from "./names.js";
import { fillAs, strokeAs, tracedDisc, write } from "./shapes.js";

const DASH = [5, 4];

export function drawZones(/** @type {View} */ view) {
  for (const zone of view.mission.zones) {
    const corners = zone.area ? [traceArea(view, zone.area)] : markTasks(view, zone);
    if (!corners.length) continue;
    const { ctx, history, scene, theme } = view;
    const doing = (task) => serviceAfter(history, task, scene.step)?.doing;
    const served = zone.tasks.filter((task) => ![undefined, CARRYING, UNLOADING].includes(doing(task)));
    const busy = served.length + zone.loads.filter((task) => doing(task) === UNLOADING).length;
    const colour = busy < zone.room ? theme.muted : theme.wait;
    const text = `${zone.name} ${busy}/${zone.room}`;
    ctx.font = `11px ${theme.font}`;
    const half = ctx.measureText(text).width / 2;
    const at = corners.find(({ x, y }) => !isOverTask(view, { x: x + half, y: y - 6, half })) ?? corners[0];
    write(ctx, text, at.x, at.y, colour, ctx.font, "left", "bottom", theme.ground);
  }
}

// Returns where its name goes: at its left upper corner.
function traceArea(/** @type {View} */ { ctx, camera, theme }, /** @type {Place[]} */ [low, high]) {
  const reach = camera.middle * camera.cell; // a cell is wider than its middle
  const [left, right] = [camera.x(low[0]) - reach, camera.x(high[0]) + reach];
  const [one, other] = [camera.y(low[1]), camera.y(high[1])];
  const [top, bottom] = [Math.min(one, other) - reach, Math.max(one, other) + reach];
  ctx.beginPath();
  ctx.rect(left, top, right - left, bottom - top);
  fillAs(ctx, theme.wait, 0.07);
  strokeAs(ctx, theme.muted, 1, { dash: DASH });
  return { x: left + 3, y: top - 2 };
}

// Where no area says where it is, its tasks are ringed, and where loads are brought to. Returns where
// its name may go: at the upper right of each ring.
function markTasks(/** @type {View} */ { ctx, camera, theme, mission }, zone) {
  const r = Math.max(9, 0.75 * camera.cell);
  const places = [...zone.tasks.map((task) => mission.tasks[task].at), ...zone.loads.map((task) => mission.tasks[task].to)];
  const spots = places.map(([x, y]) => ({ x: camera.x(x), y: camera.y(y) }));
  for (const { x, y } of spots) {
    tracedDisc(ctx, x, y, r);
    strokeAs(ctx, theme.muted, 1, { dash: DASH });
  }
  return spots.map(({ x, y }) => ({ x: x + r, y: y - r }));
}
