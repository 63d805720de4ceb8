// What a mission cost, and what records of it are judged by, the less the better.

import { exact } from "./counts.js";
import { hasDueTimes } from "./mission.js";

const LATENESS = 2; // what it weighs beside the makespan in a mission with windows and without a cost

// What the mission cost, by its own weights, if it has a cost and is over; else null. In continuous time
// the record says it.
export function costOf(/** @type {TrialHistory} */ history) {
  if (!history.mission.cost) return null;
  return history.isContinuous ? (history.end.cost ?? null) : weighedBy(history.mission.cost, history);
}

// Whether records of a mission are judged by more than the makespan, as plans of it are.
export function isWeighed(/** @type {Mission} */ mission) {
  return Boolean(mission.cost) || hasDueTimes(mission);
}

// The cost or, where tasks have windows, what makespan and lateness weigh; null while it is not over.
export function weighedValue(/** @type {TrialHistory} */ history) {
  return history.mission.cost ? costOf(history) : weighedBy({ makespan: 1, tardiness: LATENESS }, history);
}

// What was missed, by weight.
export function missedWeight(/** @type {TrialHistory} */ { mission, missed }) {
  return [...missed.keys()].reduce((sum, task) => exact(sum + mission.tasks[task].weight), 0);
}

// The mean by weight of when all is over, when tasks are done and how late, and what is missed.
function weighedBy(weights, /** @type {TrialHistory} */ history) {
  const { mission, doneAt, end } = history;
  const { tasks } = mission;
  if (end.makespan === null) return null;
  const done = [...tasks.keys()].filter((task) => doneAt[task] < Infinity);
  const late = done.map((task) => Math.max(0, doneAt[task] - tasks[task].due));
  const sum = (values) => values.reduce((total, value) => total + value, 0);
  const parts = {
    makespan: end.makespan,
    tardiness: sum(done.map((task, at) => late[at] * tasks[task].weight)),
    max_tardiness: Math.max(0, ...late),
    completion: sum(done.map((task) => tasks[task].weight * doneAt[task])),
    missed: missedWeight(history),
  };
  const weighed = Object.entries(weights).map(([part, weight]) => weight * parts[part]);
  return sum(weighed) / sum(Object.values(weights));
}
