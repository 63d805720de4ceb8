// Who stays with a task that has a duration, and since when: the record says only when it was done.

// Returns what to call after each step. A team that stands at such a task and covers it begins;
// it goes on until the record says done, or until the team no longer covers it. Of a team that
// parts (robots that run by themselves may) the first part that covers it goes on.
function serviceKeeper(history) {
  const { scenario, services, events } = history;
  const lasting = scenario.tasks
    .map((_, task) => task)
    .filter((task) => scenario.tasks[task].duration > 0 || scenario.tasks[task].to)
    .sort((one, other) => !scenario.tasks[one].to - !scenario.tasks[other].to || one - other);
  const running = new Map(); // task -> its service, with the robots that began it
  return (state, change, step) => {
    if (!lasting.length) return;
    const teamsAt = teamFinder(scenario.world, state);
    endServices(history, running, state, change, step);
    for (const task of lasting) {
      if (running.has(task) || isClosed(history, task, step)) continue;
      if (isDoneIn(change, task) || isSetDownIn(change, task)) continue;
      const busy = [...running].filter(([other]) => scenario.tasks[other].to).map(([, { slot }]) => slot);
      const service = findServer(history, state, teamsAt, task, step, busy);
      if (!service) continue;
      running.set(task, service);
      services[task].push(service);
      events.push({ step, kind: "begins", task, slot: service.slot, size: service.robots.length });
    }
  };
}

function isClosed(history, task, step) {
  const { appears, opens, cancelled } = history.scenario.tasks[task];
  return history.doneAt[task] < Infinity || cancelled <= step || Math.max(appears, opens) >= step;
}

function isDoneIn(change, task) {
  return (change.done ?? []).some(([done]) => done === task);
}

function endServices(history, running, state, change, step) {
  for (const [task, service] of running) {
    const slots = robotsServing(service, step)
      .map((robot) => state.team[robot])
      .filter((slot) => slot !== NOBODY);
    const isCancelled = history.scenario.tasks[task].cancelled === step && !isDoneIn(change, task);
    if (isCancelled && slots.length) leaveLoad(history, state, slots[0], task, step);
    const hasEnded = isCancelled || isDoneIn(change, task) || isSetDownIn(change, task);
    const next = hasEnded ? undefined : slots.find((slot) => goesOn(history, state, slot, task));
    if (next !== undefined) {
      noteWhoLeft(service, state, next, step);
      service.slot = next;
    } else {
      service.to = step;
      running.delete(task);
    }
  }
}

// The robots that began a service and are with it in a step.
function robotsServing({ robots, leftIn }, step) {
  return robots.filter((robot) => !(leftIn.get(robot) < step));
}

// Write down who is not in the team that goes on with a service.
function noteWhoLeft({ robots, leftIn }, state, slot, step) {
  for (const robot of robots) {
    if (state.team[robot] !== slot && !leftIn.has(robot)) leftIn.set(robot, step);
  }
}

// A load that is called off on its way stays where its team is.
function leaveLoad({ carriedBy, moves, lies }, state, slot, task, step) {
  if (!carriedBy.delete(task)) return;
  lies[task] = [state.x[slot], state.y[slot]];
  moves.push({ step, task, at: lies[task] });
}

function isSetDownIn(change, task) {
  return (change.left ?? []).some(([left]) => left === task);
}

// A load is taken up only by a team that heads for it; `busy` teams have one and do nothing else.
function findServer(history, state, teamsAt, task, step, busy) {
  const { scenario } = history;
  const { needs, to } = scenario.tasks[task];
  const slot = teamsAt(history.lies[task]).find(
    (team) =>
      !busy.includes(team) &&
      (!to || state.task[team] === task) &&
      covers(countsOfTeam(scenario, state, team), needs),
  );
  if (slot === undefined) return null;
  return { slot, from: step, to: Infinity, robots: robotsOfTeam(state, slot), leftIn: new Map() };
}

function goesOn(history, state, slot, task) {
  const { scenario, carriedBy } = history;
  const { needs, to } = scenario.tasks[task];
  if (to && state.task[slot] !== task && state.task[slot] !== NOBODY) return false;
  const isAbout = carriedBy.has(task) || standsAt(history, state, slot, task);
  return isAbout && covers(countsOfTeam(scenario, state, slot), needs);
}

function standsAt(history, state, slot, task) {
  const place = [state.x[slot], state.y[slot]];
  return isSamePlace(history.scenario.world, place, history.lies[task]);
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
