// A draft: the tree of a scenario file, changed by functions that return another; undo and redo.

const STEPS_BACK = 200;

class Draft {
  constructor(tree) {
    this.tree = tree;
    this.before = [];
    this.after = [];
  }

  // Changes that follow each other under one `key`, such as the letters of a name, are one step.
  change(tree, key = null) {
    if (key === null || key !== this.key) {
      this.before.push(this.tree);
      if (this.before.length > STEPS_BACK) this.before.shift();
    }
    this.key = key;
    this.after = [];
    this.tree = tree;
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

// A thing of a draft is {robot} or {task}, by number, as in a selection.
function kindOf(thing) {
  return thing.robot !== undefined ? "robots" : "tasks";
}

function numberOf(thing) {
  return thing.robot ?? thing.task;
}

function withThing(tree, kind, thing) {
  return { ...tree, [kind]: [...tree[kind], thing] };
}

// What is undefined in `change` is taken out: it then has its default.
function withChange(tree, thing, change) {
  const list = tree[kindOf(thing)].map((it, number) =>
    number === numberOf(thing) ? withoutUndefined({ ...it, ...change }) : it,
  );
  return { ...tree, [kindOf(thing)]: list };
}

function withoutUndefined(thing) {
  return Object.fromEntries(Object.entries(thing).filter(([, value]) => value !== undefined));
}

// A robot that goes leaves its starting team, which goes with its last one.
function withoutThing(tree, thing) {
  const kind = kindOf(thing);
  const rest = { ...tree, [kind]: tree[kind].filter((_, number) => number !== numberOf(thing)) };
  if (kind !== "robots" || !tree.teams) return rest;
  const { name } = tree.robots[thing.robot];
  const teams = tree.teams.map((team) => team.filter((mate) => mate !== name));
  return { ...rest, teams: teams.filter((team) => team.length) };
}

function freeName(tree, kind) {
  const names = new Set(tree[kind].map(({ name }) => name));
  const letter = kind[0];
  let number = tree[kind].length + 1;
  while (names.has(`${letter}${number}`)) number++;
  return `${letter}${number}`;
}

// Walls need rows; a plain grid becomes rows that are drawn the same way up.
function withWall(tree, [x, y], isWall) {
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
function withSize(tree, width, height) {
  const { world } = tree;
  if (!world.rows) return { ...tree, world: { ...world, grid: [width, height] } };
  const row = (y) => (world.rows[y] ?? "").slice(0, width).padEnd(width, ".");
  return { ...tree, world: { ...world, rows: Array.from({ length: height }, (_, y) => row(y)) } };
}

function sizeOfWorld(world) {
  return world.grid ?? [world.rows[0].length, world.rows.length];
}

// Counts as a person writes them: a list where each is one, else a mapping.
function writtenCounts(counts) {
  const given = Object.entries(counts).filter(([, count]) => count > 0);
  if (given.every(([, count]) => count === 1)) return given.map(([name]) => name);
  return Object.fromEntries(given);
}

function readWrittenCounts(counts) {
  return Array.isArray(counts) ? Object.fromEntries(counts.map((name) => [name, 1])) : counts;
}

// A record in which nothing has happened yet, so that the map can draw a draft.
function recordOfDraft(tree) {
  const starts = tree.robots.map(({ at }, robot) => [robot, [robot], ...at]);
  const robots = tree.robots.map((robot, number) => ({ name: `r${number + 1}`, ...robot }));
  const tasks = tree.tasks.map(({ appears, ...task }, number) => ({ name: `t${number + 1}`, ...task }));
  const world = tree.world.plane ? { step: 1, unit: 0.2, arrival_radius: 0.05, ...tree.world } : tree.world;
  return {
    scenario: { ...tree, world, robots, tasks },
    policy: "",
    seed: 0,
    orders: [],
    start: starts,
    steps: [],
    end: { status: "running", makespan: null, blocked_tasks: [] },
    lower_bound: null,
  };
}
