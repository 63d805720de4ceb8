// The part of the events that concerns one robot (with the teams it is in) or one task.

import { NOBODY } from "./state.js";

export function taskStory(/** @type {TrialHistory} */ history, task) {
  return history.events.filter((event) => event.task === task);
}

// Follow the robot's team through its changing slots.
export function robotStory(/** @type {TrialHistory} */ history, robot) {
  const start = history.record.start.find(([, robots]) => robots.includes(robot));
  let team = start?.[0] ?? NOBODY;
  /** @type {HistoryEvent[]} */ const story = [];
  for (const event of history.events) {
    if (event.kind === "back" && event.robot === robot) team = NOBODY;
    const after = slotAfter(event, team, robot);
    if (after === undefined) continue;
    story.push(event);
    team = after;
  }
  return story;
}

// The slot of a robot's team after an event; undefined if the event is none of its business.
function slotAfter(/** @type {HistoryEvent} */ event, team, robot) {
  switch (event.kind) {
    case "join":
      return [event.joiner, event.partner].includes(team)
        ? Math.min(event.joiner, event.partner)
        : undefined;
    case "split": {
      const mine = [event.stay, event.leave].find((robots) => robots.includes(robot));
      return mine && Math.min(...mine);
    }
    case "lost":
      return event.slot === team ? (event.robot === robot ? NOBODY : event.heir) : undefined;
    case "back":
      return event.robot === robot ? robot : undefined;
    case "heads":
    case "begins":
    case "taken":
    case "done":
      return event.slot === team ? team : undefined;
    default:
      return undefined;
  }
}
