// Continuous time on the page: its clock goes in ticks, a round part of the mission's unit, and all times
// that the page holds are in ticks, with fractions where something happens between two of them.

export const TICKS = 600; // about so many in a mission

// The round part of a unit in which a record is shown: 1, 2 or 5 of a power of ten.
export function tickFor(length) {
  return roundUp(Math.max(length, 1e-6) / TICKS);
}

// The next round number up.
export function roundUp(number) {
  const power = 10 ** Math.floor(Math.log10(number));
  const times = [1, 2, 5, 10].find((one) => one * power >= number * (1 - 1e-9)) ?? 10;
  return Number((times * power).toPrecision(1));
}

// A mission with all its times in ticks, and its truth.
/** @returns {{mission: MissionTree, truth: any}} */
export function inTicks(/** @type {MissionTree} */ mission, truth, tick) {
  const span = (time) => (time === undefined || time === null ? time : time / tick);
  const task = (said) => ({
    ...said,
    duration: Array.isArray(said.duration) ? said.duration.map(span) : span(said.duration),
    unload: span(said.unload),
    appears: span(said.appears),
    cancelled: span(said.cancelled),
    between: said.between?.map(span),
  });
  const really = truth && {
    ...truth,
    tasks: Object.fromEntries(Object.entries(truth.tasks ?? {}).map(([name, said]) => [name, { ...said, duration: span(said.duration) }])),
    arrivals: truth.arrivals?.map(task),
  };
  return { mission: { ...mission, tasks: mission.tasks.map(task) }, truth: really };
}
