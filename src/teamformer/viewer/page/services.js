// Who stays with a task that has a duration, and since when: the record says only when it was done.

// Returns what to call after each step. A team that stands at such a task and covers it begins;
// it goes on until the record says done, or until the team no longer covers it.
function serviceKeeper(history) {
  const { scenario, services, events } = history;
  const lasting = scenario.tasks
    .map((_, task) => task)
    .filter((task) => scenario.tasks[task].duration > 0);
  const running = new Map(); // task -> its service, with the robots that began it
  return (state, change, step) => {
    if (!lasting.length) return;
    const cells = teamsByCell(state, scenario.world.width);
    endServices(scenario, running, state, change, step);
    for (const task of lasting) {
      if (running.has(task) || isClosed(history, task, step) || isDoneIn(change, task)) continue;
      const service = findServer(scenario, state, cells, task, step);
      if (!service) continue;
      running.set(task, service);
      services[task].push(service);
      events.push({ step, kind: "begins", task, slot: service.slot, size: service.robots.length });
    }
  };
}

function isClosed(history, task, step) {
  return history.doneAt[task] < Infinity || history.scenario.tasks[task].appears >= step;
}

function isDoneIn(change, task) {
  return (change.done ?? []).some(([done]) => done === task);
}

function endServices(scenario, running, state, change, step) {
  for (const [task, service] of running) {
    const slot = service.robots.map((robot) => state.team[robot]).find((team) => team !== NOBODY);
    if (
      !isDoneIn(change, task) &&
      slot !== undefined &&
      standsAndCovers(scenario, state, slot, task)
    ) {
      service.slot = slot;
    } else {
      service.to = step;
      running.delete(task);
    }
  }
}

function findServer(scenario, state, cells, task, step) {
  const [x, y] = scenario.tasks[task].at;
  const here = cells.get(y * scenario.world.width + x) ?? [];
  const slot = here.find((team) =>
    covers(countsOfTeam(scenario, state, team), scenario.tasks[task].needs),
  );
  if (slot === undefined) return null;
  return { slot, from: step, to: Infinity, robots: robotsOfTeam(state, slot) };
}

function standsAndCovers(scenario, state, slot, task) {
  const { at, needs } = scenario.tasks[task];
  const stands = state.x[slot] === at[0] && state.y[slot] === at[1];
  return stands && covers(countsOfTeam(scenario, state, slot), needs);
}

function teamsByCell(state, width) {
  const cells = new Map();
  for (let slot = 0; slot < state.team.length; slot++) {
    if (state.team[slot] !== slot) continue; // a team's slot is its lowest robot
    const cell = state.y[slot] * width + state.x[slot];
    if (cells.has(cell)) cells.get(cell).push(slot);
    else cells.set(cell, [slot]);
  }
  return cells;
}

function robotsOfTeam(state, slot) {
  const robots = [];
  for (let robot = slot; robot < state.team.length; robot++) {
    if (state.team[robot] === slot) robots.push(robot);
  }
  return robots;
}

function countsOfTeam(scenario, state, slot) {
  return addCounts(robotsOfTeam(state, slot).map((robot) => scenario.robots[robot].can));
}
