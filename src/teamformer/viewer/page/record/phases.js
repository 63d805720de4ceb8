// What each robot did in each step: the rows of the Gantt view, and the shares of its time.

const PHASES = ["walks", "waits", "forms", "serves", "idle", "lost"];
const PHASE_NAMES = {
  walks: "walking",
  waits: "waiting",
  forms: "forming",
  serves: "serving",
  idle: "idle",
  lost: "lost",
};
const [WALKS, WAITS, FORMS, SERVES, IDLE, LOST] = PHASES.keys();

// By robot, what it did in one step: `phasesIn(history, 1)` is about the first.
function phasesIn(history, step) {
  history.phases ??= [];
  for (let made = history.phases.length; made < step; made++) {
    history.phases.push(workOutPhases(history, made + 1));
  }
  return history.phases[step - 1];
}

function workOutPhases(history, step) {
  const [before, after] = [history.at(step - 1), history.at(step)];
  const forming = slotsForming(after, history.replay.steps[step - 1]);
  const serving = slotsServing(history, step);
  const pursued = pursuedIn(history, step);
  return Uint8Array.from(after.team, (slot, robot) => {
    if (slot === NOBODY || before.team[robot] === NOBODY) return LOST;
    if (forming.has(slot)) return FORMS;
    if (serving.has(slot)) return SERVES;
    const [was, is] = [placeOf(before, robot), placeOf(after, robot)];
    if (was.x !== is.x || was.y !== is.y) return WALKS;
    const task = before.task[before.team[robot]];
    const assigned = pursued.get(slot) ?? (after.task[slot] === NOBODY ? task : after.task[slot]);
    if (assigned === NOBODY) return IDLE;
    const { at } = sitesAt(history, step)[assigned];
    return isSamePlace(history.scenario.world, [is.x, is.y], at) ? WAITS : WALKS;
  });
}

// What teams pursued in a step whose assignments neither before nor after it say so: news took them back.
function pursuedIn({ replay }, step) {
  return new Map(replay.steps[step - 1].pursued ?? []);
}

function slotsForming(after, { splits = [], joins = [] }) {
  const robots = [...splits.flat(2), ...joins.map((pair) => Math.min(...pair))];
  return new Set(robots.map((robot) => after.team[robot]));
}

// A service that began at the end of a step takes the steps after it, up to the one that ends it.
function slotsServing(history, step) {
  const slots = new Set();
  for (const services of history.services) {
    for (const { slot, from, to } of services) if (from < step && step <= to) slots.add(slot);
  }
  return slots;
}

function percent(part) {
  return `${Math.round(100 * part)}%`;
}

// The task that a robot's team is about after a step, or NOBODY.
function taskOfRobot(history, robot, step) {
  const state = history.at(step);
  return state.team[robot] === NOBODY ? NOBODY : state.task[state.team[robot]];
}

// The same at the end of a run of one phase, also where the last step has taken it back.
function taskOfRun(history, robot, to) {
  const slot = history.at(to).team[robot];
  return pursuedIn(history, to).get(slot) ?? taskOfRobot(history, robot, to - 1);
}

// The runs of one phase in a robot's time: [{phase, from, to}], `from` excluded.
function phaseRuns(history, robot) {
  const runs = [];
  for (let step = 1; step <= history.last; step++) {
    const phase = phasesIn(history, step)[robot];
    const run = runs.at(-1);
    if (run?.phase === phase) run.to = step;
    else runs.push({ phase, from: step - 1, to: step });
  }
  return runs;
}

// The part of the steps up to one that each robot spent in each phase, by robot and phase.
function phaseShares(history, step) {
  const shares = history.scenario.robots.map(() => new Float64Array(PHASES.length));
  for (let made = 1; made <= step; made++) {
    phasesIn(history, made).forEach((phase, robot) => shares[robot][phase]++);
  }
  for (const row of shares) row.forEach((steps, phase) => (row[phase] = step ? steps / step : 0));
  return shares;
}
