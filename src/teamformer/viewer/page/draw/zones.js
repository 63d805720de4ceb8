// Zones: where they are, how many services go on in each, and for how many there is room.

import { CARRYING, UNLOADING, serviceAfter } from "../record/told.js";
import { fillAs, strokeAs, tracedDisc } from "./shapes.js";

const DASH = [5, 4];

// Where no area says where a zone is, its tasks are ringed, and where loads are brought to.
export function drawZones(/** @type {View} */ view) {
  const { ctx, theme, mission } = view;
  for (const zone of mission.zones) {
    if (zone.area) {
      const { left, top, right, bottom } = boxOf(view, zone.area);
      ctx.beginPath();
      ctx.rect(left, top, right - left, bottom - top);
      fillAs(ctx, theme.wait, 0.07);
      strokeAs(ctx, theme.muted, 1, { dash: DASH });
      continue;
    }
    for (const { x, y, r } of ringsOf(view, zone)) {
      tracedDisc(ctx, x, y, r);
      strokeAs(ctx, theme.muted, 1, { dash: DASH });
    }
  }
}

// What is written of each zone, and where its left end may be: at the upper left of its area, or at
// the upper right of one of its rings.
export function zoneLabels(/** @type {View} */ view) {
  const { history, scene, theme } = view;
  const doing = (task) => serviceAfter(history, task, scene.step)?.doing;
  return view.mission.zones.map((zone) => {
    const served = zone.tasks.filter((task) => ![undefined, CARRYING, UNLOADING].includes(doing(task)));
    const busy = served.length + zone.loads.filter((task) => doing(task) === UNLOADING).length;
    const area = zone.area && boxOf(view, zone.area);
    return {
      text: `${zone.name} ${busy}/${zone.room}`,
      colour: busy < zone.room ? theme.muted : theme.wait,
      corners: area ? [{ x: area.left, y: area.top }] : ringsOf(view, zone).map(({ x, y, r }) => ({ x: x + r, y: y - r })),
    };
  });
}

function boxOf(/** @type {View} */ { camera }, /** @type {Place[]} */ [low, high]) {
  const reach = camera.middle * camera.cell; // a cell is wider than its middle
  const [one, other] = [camera.y(low[1]), camera.y(high[1])];
  return {
    left: camera.x(low[0]) - reach,
    right: camera.x(high[0]) + reach,
    top: Math.min(one, other) - reach,
    bottom: Math.max(one, other) + reach,
  };
}

function ringsOf(/** @type {View} */ { camera, mission }, zone) {
  const r = Math.max(9, 0.75 * camera.cell);
  const places = [...zone.tasks.map((task) => mission.tasks[task].at), ...zone.loads.map((task) => mission.tasks[task].to)];
  return places.map(([x, y]) => ({ x: camera.x(x), y: camera.y(y), r }));
}
