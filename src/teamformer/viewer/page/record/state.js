// Where everybody is after a step: by robot the slot of its team, by slot the team's place and task.

export const NOBODY = -1;

// A state in which nobody is there: by robot the slot of its team, and by slot the team's place and task.
/** @returns {State} */
export function emptyState(count) {
  return { team: new Int32Array(count).fill(NOBODY), x: new Float64Array(count), y: new Float64Array(count), task: new Int32Array(count).fill(NOBODY) };
}

export function startState(/** @type {RecordTree} */ record, /** @type {Mission} */ mission) {
  const state = emptyState(mission.robots.length);
  for (const [slot, robots, x, y] of record.start) {
    for (const robot of robots) state.team[robot] = slot;
    putTeam(state, [slot, x, y, null]);
  }
  return state;
}

// Rows of teams that do not say what the team heads for, as it is what its slot's row said before, say so
// from now on.
export function fillHeadings(/** @type {StepTree[]} */ steps) {
  /** @type {(number | null)[]} */ const headings = [];
  for (const { teams = [] } of steps) {
    for (const row of teams) {
      if (row.length < 4) row.push(headings[row[0]] ?? null);
      headings[row[0]] = row[3];
    }
  }
}

export function copyState(/** @type {State} */ state) {
  return { team: state.team.slice(), x: state.x.slice(), y: state.y.slice(), task: state.task.slice() };
}

function putTeam(/** @type {State} */ state, [slot, x, y, task]) {
  state.x[slot] = x;
  state.y[slot] = y;
  state.task[slot] = task ?? NOBODY;
}

// The order is the record's own: splits, joins, losses, returns, then where everybody is.
export function applyStep(/** @type {State} */ state, step) {
  formTeams(state, step);
  for (const robot of step.lost ?? []) loseRobot(state, robot);
  for (const robot of step.back ?? []) state.team[robot] = robot;
  placeTeams(state, step);
}

export function formTeams(/** @type {State} */ state, step) {
  for (const parts of step.splits ?? []) splitTeam(state, parts);
  if (step.joins) joinTeams(state, step.joins);
}

export function placeTeams(/** @type {State} */ state, step) {
  for (const team of step.teams ?? []) putTeam(state, team);
}

function splitTeam(/** @type {State} */ state, parts) {
  const before = state.team[parts[0][0]];
  for (const robots of parts) {
    const slot = Math.min(...robots);
    for (const robot of robots) state.team[robot] = slot;
    if (slot !== before) putTeam(state, [slot, state.x[before], state.y[before], null]);
  }
}

export function placeOf(/** @type {State} */ state, robot) {
  const slot = state.team[robot];
  return { x: state.x[slot], y: state.y[slot] };
}

// A team takes part in one formation a step at most, so one pass over the robots is enough.
function joinTeams(/** @type {State} */ state, joins) {
  const renamed = new Map();
  for (const pair of joins) renamed.set(Math.max(...pair), Math.min(...pair));
  for (let robot = 0; robot < state.team.length; robot++) {
    state.team[robot] = renamed.get(state.team[robot]) ?? state.team[robot];
  }
}

// A team that loses its lowest robot is from then on known by the next.
export function loseRobot(/** @type {State} */ state, robot) {
  const slot = state.team[robot];
  state.team[robot] = NOBODY;
  if (slot !== robot) return;
  const heir = state.team.indexOf(slot);
  if (heir < 0) return;
  putTeam(state, [heir, state.x[slot], state.y[slot], state.task[slot]]);
  for (let mate = heir; mate < state.team.length; mate++) {
    if (state.team[mate] === slot) state.team[mate] = heir;
  }
}

export function robotsOfTeam(/** @type {State} */ state, slot) {
  const robots = [];
  for (let robot = slot; robot < state.team.length; robot++) {
    if (state.team[robot] === slot) robots.push(robot);
  }
  return robots;
}
