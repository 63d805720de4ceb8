// The mission of a record, with capabilities as numbers and counts as [capability, count] pairs.

import { addCounts } from "./counts.js";
import { readPlane, readRadius } from "./plane.js";

// By foresight, from which probability on plans count on needs that tasks may have.
const LEAST_CHANCE = { needed: 0, scouting: 0.25, absent: Infinity };

// `truth` says, by name, what an uncertain mission really was.
export function readMission(/** @type {MissionTree} */ tree, truth, foresight = "scouting", /** @type {World | null} */ world = null) {
  const numbers = new Map(tree.capabilities.map((name, cap) => [name, cap]));
  const listed = [...tree.tasks, ...(truth?.arrivals ?? [])];
  const opens = tree.time === "continuous" ? (between) => between?.[0] ?? 0 : windowOpens;
  const tasks = listed.map((task) => ({ ...readTask(task, numbers, truth?.tasks[task.name], LEAST_CHANCE[foresight]), opens: opens(task.between) }));
  const numberOf = new Map(tasks.map(({ name }, number) => [name, number]));
  for (const task of tasks) task.after = task.after.map((name) => numberOf.get(name));
  /** @type {Mission} */ const mission = {
    name: tree.name || "unnamed mission",
    capabilities: tree.capabilities,
    world: world ?? readWorld(tree.world),
    robots: tree.robots.map((robot) => ({
      name: robot.name,
      at: robot.at,
      can: readCounts(robot.can, numbers),
      said: robot, // as the file has it
      flies: robot.moves === "air",
      delay: robot.delays?.chance ?? robot.delays ?? 0, // of how many steps it stands still in
    })),
    tasks,
    chargers: tree.chargers ?? [],
    zones: readZones(tree.zones ?? {}, tasks),
    tasksAt: Map.groupBy(tasks.keys(), (task) => cellKey(...tasks[task].at.map(Math.round))),
    doTasksMove: tasks.some(({ within, to }) => within || to), // in what is believed, or carried
    sensingRadius: readRadius(tree.sensing_radius),
    cost: tree.cost ?? null, // the weights by which a plan costs something, if it does
  };
  for (const task of tasks) task.first = firstPlace(mission.world, task);
  shareSites(tasks);
  return mission;
}

// Each with the numbers of its tasks, those in its area, at its places, or named, and of its loads:
// those that are brought there.
function readZones(said, /** @type {Task[]} */ tasks) {
  const isIn = ([[left, low], [right, high]], [x, y]) => left <= x && x <= right && low <= y && y <= high;
  const isAt = (places, at) => places.some(([x, y]) => x === at[0] && y === at[1]);
  return Object.entries(said).map(([name, { area, places = [], tasks: names = [], room = 1 }]) => {
    const holds = (at) => isAt(places, at) || (area && isIn(area, at));
    const has = (task) => names.includes(task.name) || holds(task.at);
    const isBrought = (task) => task.to && holds(task.to);
    const numbers = [...tasks.keys()];
    return {
      name,
      area: area ?? null,
      room,
      tasks: numbers.filter((number) => has(tasks[number])),
      loads: numbers.filter((number) => isBrought(tasks[number])),
    };
  });
}

// `appears` is when a task becomes known and `opens` when its window does, in steps made.
// `needs` and `duration` are what they really are, `sure`, `believed` and `lasts` what is known
// before; `mayNeed` has pairs of a capability and the probability that one more is needed. It is at
// `at`, known to be `within` a distance of `around`, and `first` believed to be in the nearest place.
/** @returns {any} */
function readTask(said, numbers, truth, leastChance) {
  const { name, at, within, needs, may_need, duration, appears, cancelled, after, between, to, unload, weight } = said;
  const mayNeed = Object.entries(may_need ?? {}).map(([cap, chance]) => [numbers.get(cap), chance]);
  const sure = readCounts(needs, numbers);
  const hoped = mayNeed.filter(([, chance]) => chance > 0 && chance >= leastChance).map(([cap]) => [cap, 1]);
  const [lasts, took] = Array.isArray(duration) ? [duration, duration[1]] : [null, duration ?? 0];
  return {
    name,
    said, // as the file has it
    at: truth?.at ?? at,
    around: at,
    within: within ?? 0,
    needs: truth?.needs ? readCounts(truth.needs, numbers) : sure,
    sure,
    believed: sumPairs([...sure, ...hoped]),
    mayNeed,
    lasts,
    duration: truth?.duration ?? took,
    appears: appears ?? 0,
    cancelled: cancelled ?? Infinity, // the step in which it is called off if it is not done by then
    after: after ?? [],
    to: to ?? null, // where a load is brought, and how long it takes there
    unload: unload ?? 0,
    due: between?.[1] ?? Infinity,
    weight: weight ?? 1,
  };
}

export function hasDueTimes(/** @type {Mission} */ { tasks }) {
  return tasks.some(({ due }) => due < Infinity);
}

// How many steps are made when a window begins.
function windowOpens(between) {
  return Math.ceil(between?.[0] ?? 0);
}

// The free cell that is nearest to where a task may be; of equals the lowest, then the leftmost.
function firstPlace(/** @type {World} */ { isBlocked, width, height, isPlane }, /** @type {Task} */ { around, within }) {
  const [x, y] = around;
  if (!within || isPlane || !isBlocked(x, y)) return around;
  const reach = Math.floor(within);
  /** @type {{away: number, at: Place} | null} */ let best = null;
  for (let row = Math.max(0, y - reach); row <= Math.min(height - 1, y + reach); row++) {
    for (let column = Math.max(0, x - reach); column <= Math.min(width - 1, x + reach); column++) {
      const away = (column - x) ** 2 + (row - y) ** 2;
      if (!isBlocked(column, row) && !(best && away >= best.away)) best = { away, at: [column, row] };
    }
  }
  return best ? best.at : around;
}

// Note for each task `mates`, all tasks in exactly its place.
/** @returns {Site[]} */
export function shareSites(/** @type {any[]} */ sites) {
  const keyOf = ({ at, isUp }) => (isUp ? "up" : cellKey(...at));
  const groups = Map.groupBy(sites.keys(), (task) => keyOf(sites[task]));
  sites.forEach((site, task) => (site.mates = site.isUp ? [task] : groups.get(keyOf(site))));
  return sites;
}

export function cellKey(x, y) {
  return `${x},${y}`;
}

// Whether a team gets over obstacles: all its robots fly.
export function isFlying(/** @type {Mission} */ { robots }, /** @type {Team} */ team) {
  return team.robots.every((robot) => robots[robot].flies);
}

// Counts come as {lift: 2} or as [lift, weld], one each.
function readCounts(/** @type {Iterable<Count>} */ counts, numbers) {
  const named = Array.isArray(counts) ? counts.map((name) => [name, 1]) : Object.entries(counts);
  return sumPairs(named.map(([name, count]) => [numbers.get(name), count]));
}

function sumPairs(pairs) {
  return [...addCounts([pairs])].sort((one, other) => one[0] - other[0]);
}

// A plain grid is drawn with y upwards, a map of rows as it says (downwards if it does not).
/** @returns {World} */
function readWorld(world) {
  if (world.plane) return readPlane(world);
  const rows = world.rows ?? [];
  const [width, height] = world.grid ?? [rows[0].length, rows.length];
  const yAxis = world.y_axis ?? (rows.length ? "down" : "up");
  const isBlocked = (x, y) => rows.length > 0 && rows[y][x] === "@";
  const used = usedPart(width, height, rows);
  const lengths = { isPlane: false, square: 1, arrival: 0, stepSeconds: 1, isTimed: false, secondsUnit: "" };
  return { width, height, rows, isBlocked, used, yIsUp: yAxis === "up", fields: new Map(), ...lengths };
}

// The box around all free cells, and one cell more: scanned maps have wide dead margins.
function usedPart(width, height, rows) {
  if (!rows.length) return { left: 0, low: 0, width, height };
  const columns = Array.from({ length: width }, (_, x) => x).filter((x) => rows.some((row) => row[x] !== "@"));
  const lines = rows.map((_, y) => y).filter((y) => /[^@]/.test(rows[y]));
  const [left, right] = [Math.max(0, columns[0] - 1), Math.min(width - 1, columns[columns.length - 1] + 1)];
  const [low, high] = [Math.max(0, lines[0] - 1), Math.min(height - 1, lines[lines.length - 1] + 1)];
  return { left, low, width: right - left + 1, height: high - low + 1 };
}

const FIELDS_KEPT = 64;

// Cells to go between two places, or Infinity, on planes squares straight on; distance fields are kept by their goal.
export function walkingDistance(/** @type {World} */ world, from, goal, flies = false) {
  if (world.isPlane) return Math.hypot(from[0] - goal[0], from[1] - goal[1]);
  if (flies || !world.rows.length) return Math.abs(from[0] - goal[0]) + Math.abs(from[1] - goal[1]);
  const key = goal[1] * world.width + goal[0];
  if (!world.fields.has(key) && world.fields.size >= FIELDS_KEPT) world.fields.clear();
  const field = world.fields.get(key) ?? distanceField(world, key);
  world.fields.set(key, field);
  const cells = field[from[1] * world.width + from[0]];
  return cells < 0 ? Infinity : cells;
}

// Breadth first from the goal; -1 where no way leads.
function distanceField(/** @type {World} */ world, goal) {
  const field = new Int32Array(world.width * world.height).fill(-1);
  const queue = new Int32Array(field.length);
  queue[0] = goal;
  field[goal] = 0;
  for (let head = 0, tail = 1; head < tail; head++) {
    const x = queue[head] % world.width;
    const y = (queue[head] - x) / world.width;
    for (const [right, up] of SIDES) {
      const cell = (y + up) * world.width + x + right;
      if (!isFreeCell(world, x + right, y + up) || field[cell] >= 0) continue;
      field[cell] = field[queue[head]] + 1;
      queue[tail++] = cell;
    }
  }
  return field;
}

export const SIDES = [
  [1, 0],
  [-1, 0],
  [0, 1],
  [0, -1],
];

export function isFreeCell(/** @type {World} */ world, x, y) {
  return x >= 0 && y >= 0 && x < world.width && y < world.height && !world.isBlocked(x, y);
}
