// Who stays with a task that has a duration, and since when: the record says only when it was done.
// @ts-nocheck

import { covers } from "./counts.js";
import { cellKey } from "./mission.js";
import { isSamePlace } from "./plane.js";
import { NOBODY, countsOfTeam, robotsOfTeam } from "./state.js";

// Returns what to call after each step. A team that stands at such a task and covers it begins;
// it goes on until the record says done, or until the team no longer covers it. Of a team that
// parts (robots that run by themselves may) the first part that covers it goes on. Who takes up a
// load is recorded, and its robots have it until the record says that it is down, in however many
// teams they are.
export function serviceKeeper(history) {
  const { mission, services, events } = history;
  const lasting = mission.tasks
    .map((_, task) => task)
    .filter((task) => mission.tasks[task].duration > 0 || mission.tasks[task].to)
    .sort((one, other) => !mission.tasks[one].to - !mission.tasks[other].to || one - other);
  const running = new Map(); // task -> its service, with the robots that began it
  return (state, change, step) => {
    if (!lasting.length) return;
    const teamsAt = teamFinder(mission.world, state);
    const takers = new Map(takenIn(history, change, step));
    endServices(history, running, state, change, step, takers);
    for (const task of lasting) {
      if (running.has(task) || isDoneIn(change, task)) continue;
      const rests = isSetDownIn(change, task) || isClosed(history, task, step);
      if (rests && !takers.has(task)) continue; // or it was set down and taken up again
      const loads = [...running].filter(([other]) => mission.tasks[other].to);
      const busy = loads.flatMap(([, service]) => robotsServing(service, step + 1).map((robot) => state.team[robot]));
      const slot = takers.get(task) ?? findServer(history, state, teamsAt, task, busy);
      if (slot === undefined) continue;
      const service = { slot, from: step, to: Infinity, robots: robotsOfTeam(state, slot), leftIn: new Map() };
      running.set(task, service);
      services[task].push(service);
      events.push({ step, kind: "begins", task, slot: service.slot, size: service.robots.length });
    }
  };
}

function isClosed(history, task, step) {
  const { appears, opens, cancelled } = history.mission.tasks[task];
  return history.doneAt[task] < Infinity || cancelled <= step || Math.max(appears, opens) >= step;
}

function isDoneIn(change, task) {
  return (change.done ?? []).some(([done]) => done === task);
}

// Loads that teams take up in a step: [task, slot].
export function takenIn({ mission, doneAt }, { taken = [] }, step) {
  return taken.filter(([task]) => {
    const { to, cancelled } = mission.tasks[task];
    return to && cancelled > step && doneAt[task] === Infinity;
  });
}

function endServices(history, running, state, change, step, takers) {
  for (const [task, service] of running) {
    const slots = robotsServing(service, step)
      .map((robot) => state.team[robot])
      .filter((slot) => slot !== NOBODY);
    const isCancelled = history.mission.tasks[task].cancelled === step && !isDoneIn(change, task);
    const isUp = history.carriedBy.has(task);
    if (isCancelled || (isUp && !slots.length)) leaveLoad(history, state, slots[0] ?? service.slot, task, step);
    const hasEnded = isCancelled || isDoneIn(change, task) || isSetDownIn(change, task);
    const next = hasEnded ? [] : whoGoesOn(history, state, slots, task, takers.get(task));
    if (next.length) {
      noteWhoLeft(service, state, next, step);
      service.slot = next[0];
    } else {
      service.to = step;
      running.delete(task);
    }
  }
}

// The teams that go on with a service, of those that its robots are in: one, or all who have a load
// up. If they part, those have it that can carry it and head for nothing else; if no part can, all
// that head for nothing else. Nobody puts a load down by heading elsewhere: the record says if it is.
function whoGoesOn(history, state, slots, task, taker) {
  if (taker !== undefined) return slots.filter((slot) => slot === taker).slice(0, 1);
  if (!history.carriedBy.has(task)) return slots.filter((slot) => goesOn(history, state, slot, task)).slice(0, 1);
  const about = slots.filter((slot) => isAbout(history, state, slot, task));
  const able = about.filter((slot) => isAble(history, state, slot, task));
  return [able, about].find((going) => going.length) ?? slots;
}

// The robots that began a service and are with it in a step.
export function robotsServing({ robots, leftIn }, step) {
  return robots.filter((robot) => !(leftIn.get(robot) < step));
}

// Write down who is not in the teams that go on with a service.
function noteWhoLeft({ robots, leftIn }, state, slots, step) {
  for (const robot of robots) {
    if (!slots.includes(state.team[robot]) && !leftIn.has(robot)) leftIn.set(robot, step);
  }
}

// A load that is called off on its way, or that nobody is left to carry, stays where its team is.
function leaveLoad({ carriedBy, moves, lies }, state, slot, task, step) {
  if (!carriedBy.delete(task)) return;
  lies[task] = [state.x[slot], state.y[slot]];
  moves.push({ step, task, at: lies[task] });
}

function isSetDownIn(change, task) {
  return (change.left ?? []).some(([left]) => left === task);
}

// A load is taken up only by a team that heads for it; `busy` teams have one and do nothing else.
function findServer(history, state, teamsAt, task, busy) {
  const { mission } = history;
  const { needs, to } = mission.tasks[task];
  return teamsAt(history.lies[task]).find(
    (team) =>
      !busy.includes(team) &&
      (!to || state.task[team] === task) &&
      covers(countsOfTeam(mission, state, team), needs),
  );
}

function goesOn(history, state, slot, task) {
  return [isAbout, standsAt, isAble].every((holds) => holds(history, state, slot, task));
}

// Whether a team heads for no other task than a load.
function isAbout({ mission }, state, slot, task) {
  return !mission.tasks[task].to || [task, NOBODY].includes(state.task[slot]);
}

function isAble({ mission }, state, slot, task) {
  return covers(countsOfTeam(mission, state, slot), mission.tasks[task].needs);
}

function standsAt(history, state, slot, task) {
  const place = [state.x[slot], state.y[slot]];
  return isSamePlace(history.mission.world, place, history.lies[task]);
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
