// The part of the events that concerns one robot (with the teams it is in) or one task.

export function taskStory(/** @type {TrialHistory} */ { events }, task) {
  return events.filter((event) => event.task === task);
}

export function robotStory(/** @type {TrialHistory} */ { events }, robot) {
  return events.filter(({ robots }) => robots?.includes(robot));
}
