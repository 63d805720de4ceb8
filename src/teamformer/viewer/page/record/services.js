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
    const teamsAt = teamFinder(scenario.world, state);
    endServices(scenario, running, state, change, step);
    for (const task of lasting) {
      if (running.has(task) || isClosed(history, task, step) || isDoneIn(change, task)) continue;
      const service = findServer(scenario, state, teamsAt, task, step);
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

function findServer(scenario, state, teamsAt, task, step) {
  const slot = teamsAt(scenario.tasks[task].at).find((team) =>
    covers(countsOfTeam(scenario, state, team), scenario.tasks[task].needs),
  );
  if (slot === undefined) return null;
  return { slot, from: step, to: Infinity, robots: robotsOfTeam(state, slot) };
}

function standsAndCovers(scenario, state, slot, task) {
  const { at, needs } = scenario.tasks[task];
  const stands = isSamePlace(scenario.world, [state.x[slot], state.y[slot]], at);
  return stands && covers(countsOfTeam(scenario, state, slot), needs);
}

// Returns what finds the slots of the teams in a place, lowest first.
function teamFinder(world, state) {
  const slots = [...state.team.keys()].filter((slot) => state.team[slot] === slot);
  if (world.isPlane) {
    return (at) => slots.filter((slot) => isSamePlace(world, [state.x[slot], state.y[slot]], at));
  }
  const cells = new Map();
  for (const slot of slots) {
    const cell = cellKey(state.x[slot], state.y[slot]);
    if (cells.has(cell)) cells.get(cell).push(slot);
    else cells.set(cell, [slot]);
  }
  return (at) => cells.get(cellKey(...at)) ?? [];
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
