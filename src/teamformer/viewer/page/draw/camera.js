// From cells to pixels and back: fit, pan, zoom. Only here does y turn.

const MOST_PIXELS_PER_CELL = 96;
const AROUND = [60, 72]; // pixels left and right, over and under a map that is fitted
const LEAST_PIXELS_PER_CELL = 1.5; // unless less is needed to show all

const AROUND_ON_PHONES = [52, 60];
export const PHONE = 480; // pixels across

// The pixels a cell at which what is used of a world fits into a box.
export function scaleToFit(used, width, height) {
  const [across, down] = width <= PHONE ? AROUND_ON_PHONES : AROUND;
  return Math.min((width - across) / used.width, (height - down) / used.height);
}

export class Camera {
  constructor(/** @type {World} */ world) {
    this.world = world;
    this.middle = world.isPlane ? 0 : 0.5; // whole numbers are the middles of cells
    this.cell = 1; // pixels
    this.least = LEAST_PIXELS_PER_CELL;
    this.left = 0;
    this.top = 0;
    this.isFitted = true;
  }

  // `above` is what has to stay free over the map.
  fit(width, height, above = 0) {
    const { used } = this.world;
    const wanted = scaleToFit(used, width, height - above);
    this.least = wanted > 0 ? Math.min(wanted, LEAST_PIXELS_PER_CELL) : LEAST_PIXELS_PER_CELL;
    this.cell = Math.max(this.least, Math.min(wanted, MOST_PIXELS_PER_CELL));
    const first = this.world.yIsUp ? this.world.height - used.low - used.height : used.low;
    this.left = (width - this.cell * used.width) / 2 - this.cell * used.left;
    this.top = above + (height - above - this.cell * used.height) / 2 - this.cell * first;
    this.isFitted = true;
  }

  pan(right, down) {
    this.left += right;
    this.top += down;
    this.isFitted = false;
  }

  zoom(factor, x, y) {
    const wanted = this.cell * factor;
    const cell = Math.max(this.least, Math.min(wanted, MOST_PIXELS_PER_CELL * 2));
    this.left = x - ((x - this.left) * cell) / this.cell;
    this.top = y - ((y - this.top) * cell) / this.cell;
    this.cell = cell;
    this.isFitted = false;
  }

  // The pixel of a place.
  x(x) {
    return this.left + (x + this.middle) * this.cell;
  }

  y(y) {
    return this.top + (this.turned(y) + this.middle) * this.cell;
  }

  turned(y) {
    return this.world.yIsUp ? this.world.height - 2 * this.middle - y : y;
  }

  // The place under a pixel.
  /** @returns {Place} */
  placeAt(px, py) {
    const y = (py - this.top) / this.cell - this.middle;
    return [(px - this.left) / this.cell - this.middle, this.turned(y)];
  }
}
