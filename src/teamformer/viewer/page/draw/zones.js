// Zones: where they are, how many services go on in each, and for how many there is room.

import { CARRYING, UNLOADING, serviceAfter } from "../record/told.js";
import { fillAs, strokeAs, write } from "./shapes.js";

const DASH = [5, 4];

export function drawZones(/** @type {View} */ view) {
  for (const zone of view.mission.zones) {
    const at = zone.area ? traceArea(view, zone.area) : markTasks(view, zone);
    if (!at) continue;
    const { history, scene, theme } = view;
    const doing = (task) => serviceAfter(history, task, scene.step)?.doing;
    const served = zone.tasks.filter((task) => ![undefined, CARRYING, UNLOADING].includes(doing(task)));
    const busy = served.length + zone.loads.filter((task) => doing(task) === UNLOADING).length;
    const colour = busy < zone.room ? theme.muted : theme.wait;
    write(view.ctx, `${zone.name} ${busy}/${zone.room}`, at.x, at.y, colour, `11px ${theme.font}`, "left", "bottom", theme.ground);
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

// Where no area says where it is, its tasks are ringed, and where loads are brought to.
function markTasks(/** @type {View} */ { ctx, camera, theme, mission }, zone) {
  const r = Math.max(9, 0.75 * camera.cell);
  const places = [...zone.tasks.map((task) => mission.tasks[task].at), ...zone.loads.map((task) => mission.tasks[task].to)];
  const spots = places.map(([x, y]) => ({ x: camera.x(x), y: camera.y(y) }));
  for (const { x, y } of spots) {
    ctx.beginPath();
    ctx.arc(x, y, r, 0, 2 * Math.PI);
    strokeAs(ctx, theme.muted, 1, { dash: DASH });
  }
  return spots.length ? { x: spots[0].x + r, y: spots[0].y - r } : null;
}
