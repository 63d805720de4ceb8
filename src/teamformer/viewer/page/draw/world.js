// The ground: grid lines, obstacles, zones, chargers and the numbers along two sides.

import { drawDisc, fillAs, penOf, strokeAs, traceLine, write } from "./shapes.js";
import { drawZones } from "./zones.js";

export function drawWorld(/** @type {View} */ view) {
  const { ctx, camera, theme, mission } = view;
  const { world } = mission;
  const [width, height] = [camera.cell * world.width, camera.cell * world.height];
  ctx.fillStyle = theme.ground;
  ctx.fillRect(camera.left, camera.top, width, height);
  if (world.roads) drawRoads(view);
  else if (camera.cell >= 9) drawGridLines(view, width, height);
  if (world.rows.length) {
    ctx.imageSmoothingEnabled = false;
    ctx.drawImage(wallsImage(world, theme.wall), camera.left, camera.top, width, height);
    ctx.imageSmoothingEnabled = true;
  }
  ctx.strokeStyle = theme.edge;
  ctx.lineWidth = 1;
  ctx.strokeRect(camera.left - 0.5, camera.top - 0.5, width + 1, height + 1);
  if (!world.roads) drawNumbers(view);
  drawZones(view);
  for (const { at } of mission.chargers) drawCharger(view, at);
}

// A flash in a disc, in sixths of its radius.
const FLASH = [[1, -4], [-3, 1], [-0.5, 1], [-1, 4], [3, -1], [0.5, -1]];

function drawCharger(/** @type {View} */ { ctx, camera, theme }, /** @type {Place} */ at) {
  const [x, y, r] = [camera.x(at[0]), camera.y(at[1]), Math.max(6, Math.min(14, 0.5 * camera.cell))];
  drawDisc(ctx, x, y, r, theme.edge);
  traceLine(ctx, FLASH.map(([right, down]) => ({ x: x + (right * r) / 6, y: y + (down * r) / 6 })));
  fillAs(ctx, theme.muted);
}

const ROAD = 0.16; // of a square

// Places as dots, and the roads between them; `names.js` has their names.
function drawRoads(/** @type {View} */ { ctx, camera, theme, mission }) {
  const { places, pairs } = /** @type {Roads} */ (mission.world.roads);
  const spots = places.map(([x, y]) => ({ x: camera.x(x), y: camera.y(y) }));
  ctx.lineCap = "round";
  for (const [one, other] of pairs) {
    traceLine(ctx, [spots[one], spots[other]]);
    strokeAs(ctx, theme.grid, Math.max(2, ROAD * camera.cell));
  }
  ctx.lineCap = "butt";
  for (const { x, y } of spots) drawDisc(ctx, x, y, Math.max(2.5, 0.2 * camera.cell), theme.edge);
}

// On a plane from its lower left corner.
function drawGridLines(/** @type {View} */ { ctx, camera, theme, mission }, width, height) {
  ctx.beginPath();
  for (let column = 1; column < mission.world.width; column++) {
    const x = Math.round(camera.left + column * camera.cell) + 0.5;
    ctx.moveTo(x, camera.top);
    ctx.lineTo(x, camera.top + height);
  }
  for (let row = 1; row < mission.world.height; row++) {
    const up = mission.world.yIsUp ? mission.world.height - row : row;
    const y = Math.round(camera.top + up * camera.cell) + 0.5;
    ctx.moveTo(camera.left, y);
    ctx.lineTo(camera.left + width, y);
  }
  strokeAs(ctx, theme.grid, 1);
}

// One pixel for each cell, drawn once for each colour and scaled up.
function wallsImage(/** @type {World} */ world, colour) {
  if (world.image && world.image.colour === colour) return world.image.canvas;
  const canvas = document.createElement("canvas");
  canvas.width = world.width;
  canvas.height = world.height;
  const ctx = penOf(canvas);
  ctx.fillStyle = colour;
  world.rows.forEach((row, y) => {
    const top = world.yIsUp ? world.height - 1 - y : y;
    for (let x = 0; x < world.width; x++) if (row[x] === "@") ctx.fillRect(x, top, 1, 1);
  });
  world.image = { canvas, colour };
  return canvas;
}

export const SPACINGS = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000];

// x along the bottom and y along the left, at a spacing that leaves room for the digits: the
// numbers of cells, or metres on a plane.
function drawNumbers(/** @type {View} */ { ctx, camera, theme, mission }) {
  const { world } = mission;
  const { isPlane, square } = world;
  const spacings = isPlane ? SPACINGS : SPACINGS.filter(Number.isInteger);
  const every = spacings.find((step) => (step / square) * camera.cell >= 34) ?? spacings[spacings.length - 1];
  const marks = (side) => {
    const last = isPlane ? side * square : side - 1;
    return Array.from({ length: Math.floor(last / every + 1e-9) + 1 }, (_, mark) => mark * every);
  };
  const unit = isPlane ? " m" : "";
  const font = `10px ${theme.font}`;
  const below = camera.top + world.height * camera.cell + 18; // names of tasks come first
  for (const x of marks(world.width)) write(ctx, short(x) + unit, camera.x(x / square), below, theme.faint, font, "center", "top");
  for (const y of marks(world.height)) write(ctx, short(y), camera.left - 7, camera.y(y / square), theme.faint, font, "right");
}

function short(number) {
  return String(Number(number.toFixed(1)));
}
