// A draft: the tree of a mission file, changed by functions that return another; undo and redo.

const STEPS_BACK = 200;

class Draft {
  constructor(/** @type {MissionTree} */ tree) {
    this.tree = tree;
    this.before = [];
    this.after = [];
  }

  // Changes that follow each other under one `key`, such as the letters of a name, are one step.
  change(/** @type {MissionTree} */ tree, /** @type {string | null} */ key = null) {
    if (tree === this.tree) return;
    if (key === null || key !== this.key) {
      this.before.push(this.tree);
      if (this.before.length > STEPS_BACK) this.before.shift();
    }
    this.key = key;
    this.after = [];
    this.tree = tree;
  }

  // What the tree was before the changes under a key that are going on, else what it is.
  beforeChanges(key) {
    return key === this.key ? this.before.at(-1) : this.tree;
  }

  undo() {
    this.move(this.before, this.after);
  }

  redo() {
    this.move(this.after, this.before);
  }

  move(from, to) {
    if (!from.length) return;
    to.push(this.tree);
    this.tree = from.pop();
    this.key = null;
  }
}

const KEPT = "teamformer drawing"; // the key in what the browser keeps for this tab
const MOST_KEPT = 2_000_000; // letters

// The drawing of a page that goes, for the next page of this tab, and what can be undone: as much of
// it as there is room for.
export function keepDraft({ tree, before, after }) {
  const write = (last, next) => JSON.stringify({ tree, before: last, after: next });
  let text = write(before, after);
  for (let kept = before.length; text.length > MOST_KEPT && kept > 0;) {
    kept = Math.floor(kept / 2);
    text = write(kept ? before.slice(-kept) : [], []);
  }
  try {
    sessionStorage.setItem(KEPT, text);
  } catch {
    sessionStorage.removeItem(KEPT); // the browser keeps less
  }
}

// The draft of a tree; what was undone and done is there again where the tree is as this tab left it.
export function keptDraft(/** @type {MissionTree} */ tree) {
  const draft = new Draft(tree);
  const kept = JSON.parse(sessionStorage.getItem(KEPT) ?? "{}");
  if (JSON.stringify(kept.tree) !== JSON.stringify(tree)) return draft;
  return Object.assign(draft, { before: kept.before, after: kept.after });
}

// A thing of a draft is {robot} or {task}, by number, as in a selection.
export function kindOf(/** @type {Thing} */ thing) {
  return thing.robot !== undefined ? "robots" : "tasks";
}

export function numberOf(/** @type {Thing} */ thing) {
  return Number(thing.robot ?? thing.task);
}

export function withThing(/** @type {MissionTree} */ tree, kind, thing) {
  return { ...tree, [kind]: [...tree[kind], thing] };
}

// What is undefined in `change` is taken out: it then has its default.
export function withChange(/** @type {MissionTree} */ tree, /** @type {Thing} */ thing, /** @type {StepTree} */ change) {
  const list = tree[kindOf(thing)].map((it, number) => (number === numberOf(thing) ? withoutUndefined({ ...it, ...change }) : it));
  return { ...tree, [kindOf(thing)]: list };
}

// The tree with another name for a thing, in all that refers to it too: tasks that come after it or
// start with it, starting teams.
export function withName(/** @type {MissionTree} */ tree, /** @type {Thing} */ thing, name) {
  const changed = withChange(tree, thing, { name });
  if (!name) return changed;
  const { count } = tree[kindOf(thing)][numberOf(thing)];
  const old = nameIn(tree, thing);
  const names = new Map(count === undefined ? [[old, name]] : []);
  for (let one = 1; one <= (count ?? 0); one++) names.set(`${old}-${one}`, `${name}-${one}`);
  const swap = (other) => names.get(other) ?? other;
  if (kindOf(thing) === "robots") {
    return changed.teams ? { ...changed, teams: changed.teams.map((team) => team.map(swap)) } : changed;
  }
  return { ...changed, tasks: changed.tasks.map((task) => withReferences(task, swap)) };
}

function withReferences(task, swap) {
  const { after, starts } = task;
  const changed = { ...task };
  if (Array.isArray(after)) changed.after = after.map(swap);
  if (starts) changed.starts = Object.fromEntries(Object.entries(starts).map(([other, gap]) => [swap(other), gap]));
  return changed;
}

// What the file reader calls a thing, be it without a name: by its place among all.
function nameIn(/** @type {MissionTree} */ tree, /** @type {Thing} */ thing) {
  const list = tree[kindOf(thing)];
  const { name } = list[numberOf(thing)];
  if (name !== undefined) return name;
  const before = list.slice(0, numberOf(thing)).reduce((sum, { count }) => sum + (count ?? 1), 0);
  return `${kindOf(thing)[0]}${before + 1}`;
}

function withoutUndefined(/** @type {Thing} */ thing) {
  return Object.fromEntries(Object.entries(thing).filter(([, value]) => value !== undefined));
}

// A robot that goes leaves its starting team, which goes with its last one.
export function withoutThing(/** @type {MissionTree} */ tree, /** @type {Thing} */ thing) {
  const kind = kindOf(thing);
  const rest = { ...tree, [kind]: tree[kind].filter((_, number) => number !== numberOf(thing)) };
  if (kind !== "robots" || !tree.teams) return rest;
  const { name } = tree.robots[numberOf(thing)];
  const teams = tree.teams.map((team) => team.filter((mate) => mate !== name));
  return { ...rest, teams: teams.filter((team) => team.length) };
}

export function freeName(/** @type {MissionTree} */ tree, kind) {
  const names = new Set(tree[kind].map(({ name }) => name));
  const letter = kind[0];
  let number = tree[kind].length + 1;
  while (names.has(`${letter}${number}`)) number++;
  return `${letter}${number}`;
}

// Walls need rows; a plain grid becomes rows that are drawn the same way up.
export function withWall(/** @type {MissionTree} */ tree, /** @type {Place} */ [x, y], isWall) {
  const { world } = tree;
  const rows = world.rows ?? emptyRows(world.grid);
  if (rows[y]?.[x] === undefined) return tree;
  const row = rows[y].slice(0, x) + (isWall ? "@" : ".") + rows[y].slice(x + 1);
  const y_axis = world.y_axis ?? (world.rows ? "down" : "up");
  return { ...tree, world: { rows: rows.map((it, at) => (at === y ? row : it)), y_axis } };
}

function emptyRows([width, height]) {
  return Array.from({ length: height }, () => ".".repeat(width));
}

// A grid of another size; what lay beyond it is cut off, what is new is free.
export function withSize(/** @type {MissionTree} */ tree, width, height) {
  const { world } = tree;
  if (!world.rows) return { ...tree, world: { ...world, grid: [width, height] } };
  const row = (y) => (world.rows[y] ?? "").slice(0, width).padEnd(width, ".");
  return { ...tree, world: { ...world, rows: Array.from({ length: height }, (_, y) => row(y)) } };
}

export function sizeOfWorld(world) {
  return world.grid ?? [world.rows[0].length, world.rows.length];
}

// Counts as a person writes them: a list where each is one, else a mapping.
export function writtenCounts(/** @type {Record<string, number>} */ counts) {
  const given = Object.entries(counts).filter(([, count]) => count > 0);
  if (given.every(([, count]) => count === 1)) return given.map(([name]) => name);
  return Object.fromEntries(given);
}

export function readWrittenCounts(counts) {
  return Array.isArray(counts) ? Object.fromEntries(counts.map((name) => [name, 1])) : counts;
}

// Tasks that appear later, be it after others, are drawn too.
function shownTask({ appears, cancelled, after, between, ...task }, name) {
  return { ...task, name };
}

function drawnName(/** @type {MissionTree} */ tree, /** @type {Thing} */ thing) {
  const { count } = tree[kindOf(thing)][numberOf(thing)];
  return count > 1 ? `${nameIn(tree, thing)} × ${count}` : nameIn(tree, thing);
}

// A record in which nothing has happened yet, so that the map can draw a draft.
/** @returns {any} */
export function recordOfDraft(/** @type {MissionTree} */ tree) {
  if (tree.world.roads) return { mission: tree, method: "", seed: 0, events: [], now: 0, end: { status: "running", makespan: null }, lower_bound: null };
  const starts = tree.robots.map(({ at }, robot) => [robot, [robot], ...at]);
  const robots = tree.robots.map((robot, number) => ({ ...robot, name: drawnName(tree, { robot: number }) }));
  const tasks = tree.tasks.map((task, number) => shownTask(task, drawnName(tree, { task: number })));
  const world = tree.world.plane ? { step: 1, unit: 0.2, arrival_radius: 0.05, ...tree.world } : tree.world;
  return {
    mission: { ...tree, world, robots, tasks },
    method: "",
    seed: 0,
    orders: [],
    start: starts,
    steps: [],
    end: { status: "running", makespan: null, blocked_tasks: [] },
    lower_bound: null,
  };
}
