// Arithmetic on capability counts: a team has a Map capability -> count, a task needs pairs. Counts
// may be fractions, exact to three places: every sum is rounded to them.

export function exact(count) {
  return Math.round(count * 1000) / 1000;
}

// How many pieces a count is drawn in: one each, or one for all of what is measured.
export function piecesOf(count) {
  return Number.isInteger(count) && count <= MOST_PIECES ? count : 1;
}

const MOST_PIECES = 24;

export function addCounts(/** @type {Iterable<Count>[]} */ parts) {
  /** @type {Map<number, number>} */ const total = new Map();
  for (const part of parts) {
    for (const [cap, count] of part) total.set(cap, exact((total.get(cap) ?? 0) + count));
  }
  return total;
}

export function covers(/** @type {Map<number, number>} */ have, /** @type {Counts} */ needs) {
  return needs.every(([cap, count]) => (have.get(cap) ?? 0) >= count);
}

// What is needed beyond what is there.
/** @returns {Counts} */
export function missing(/** @type {Map<number, number>} */ have, /** @type {Counts} */ needs) {
  return needs.map(([cap, count]) => /** @type {Count} */ ([cap, exact(count - (have.get(cap) ?? 0))])).filter(([, count]) => count > 0);
}

// What of the wanted counts is there.
/** @returns {Counts} */
export function overlap(/** @type {Map<number, number>} */ have, /** @type {Counts} */ wanted) {
  return wanted.map(([cap, count]) => /** @type {Count} */ ([cap, Math.min(count, have.get(cap) ?? 0)])).filter(([, count]) => count > 0);
}

export function sumCounts(/** @type {Iterable<Count>} */ counts) {
  let sum = 0;
  for (const [, count] of counts) sum += count;
  return exact(sum);
}
