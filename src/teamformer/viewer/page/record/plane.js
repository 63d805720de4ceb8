// Planes: places in metres, which the page draws in squares as if these were cells.

const MOST_SQUARES = 300; // along a side

// The same record with all lengths in squares; on a grid, the record itself.
/** @returns {RecordTree} */
export function inSquares(/** @type {RecordTree} */ record) {
  const { world } = record.mission;
  if (!world.plane) return record;
  const square = squareOf(world);
  return {
    ...record,
    truth: truthInSquares(record.truth, square),
    mission: missionInSquares(record.mission, square),
    start: record.start.map(([slot, robots, x, y]) => [slot, robots, x / square, y / square]),
    steps: record.steps.map((step) => stepInSquares({ square }, step)),
  };
}

export function truthInSquares(truth, square) {
  if (!truth) return truth;
  const placed = (said) => (said.at ? { ...said, at: said.at.map((along) => along / square) } : said);
  const tasks = Object.entries(truth.tasks).map(([name, said]) => [name, placed(said)]);
  const arrivals = truth.arrivals?.map(placed);
  return { ...truth, tasks: Object.fromEntries(tasks), arrivals };
}

export function stepInSquares({ square }, step) {
  if (!square || !(step.teams || step.moved || step.left)) return step;
  const team = ([slot, x, y, task]) => [slot, x / square, y / square, task];
  const placed = ([task, x, y]) => [task, x / square, y / square];
  const [moved, left] = [step.moved, step.left].map((rows) => (rows ?? []).map(placed));
  return { ...step, teams: (step.teams ?? []).map(team), moved, left };
}

export function missionInSquares(/** @type {MissionTree} */ mission, square) {
  const placed = (thing) => ({ ...thing, at: thing.at.map((along) => along / square) });
  const radius = readRadius(mission.sensing_radius);
  return {
    ...mission,
    robots: mission.robots.map(placed),
    chargers: mission.chargers?.map(placed),
    zones: zonesPlaced(mission.zones, (at) => at.map((along) => along / square)),
    tasks: mission.tasks.map((task) => ({
      ...placed(task),
      within: (task.within ?? 0) / square,
      to: task.to?.map((along) => along / square),
    })),
    sensing_radius: Math.max(radius, mission.world.arrival_radius ?? 0) / square,
  };
}

// Zones with other places.
export function zonesPlaced(/** @type {Record<string, any> | undefined} */ zones, place) {
  const placed = (zone) => ({ ...zone, area: zone.area?.map(place), places: zone.places?.map(place) });
  return Object.fromEntries(Object.entries(zones ?? {}).map(([name, zone]) => [name, placed(zone)]));
}

// Metres a square: the plane's unit, or more where it is large.
export function squareOf({ plane, unit }) {
  return Math.max(unit, Math.max(...plane) / MOST_SQUARES);
}

export function readPlane(world) {
  const square = squareOf(world);
  const [width, height] = world.plane.map((side) => side / square);
  return {
    width,
    height,
    rows: [],
    isBlocked: () => false,
    used: { left: 0, low: 0, width, height },
    yIsUp: true,
    fields: new Map(),
    isPlane: true,
    square,
    arrival: (world.arrival_radius ?? 0) / square,
    stepSeconds: world.step,
    isTimed: true,
    secondsUnit: " s",
  };
}

// One cell, or points within the arrival radius.
export function isSamePlace(/** @type {World} */ world, one, other) {
  return Math.hypot(one[0] - other[0], one[1] - other[1]) <= world.arrival + 1e-9;
}

export function readRadius(radius) {
  if (radius === undefined) return 1;
  if (radius === ".inf") return Infinity;
  return radius ?? Infinity; // the page's JSON writes infinity as null
}
