// Whether a record that somebody opens can be shown at all; whether it is right, `teamformer check` says.

import { frames } from "./history.js";
import { sceneAt } from "./scene.js";
import { runsOf } from "./told.js";
import { describeEvent } from "./words.js";

const NEEDED_KEYS = ["mission", "method", "seed", "end", "lower_bound"];
const LISTS_NEEDED = { steps: ["orders", "start", "steps"], continuous: ["events"] };

// Reads a record as the page will, and throws an Error that says what goes wrong on the way.
export function tryReading(/** @type {any} */ record) {
  const lists = record.events === undefined ? LISTS_NEEDED.steps : LISTS_NEEDED.continuous;
  for (const key of [...NEEDED_KEYS, ...lists]) if (record[key] === undefined) throw new Error(`'${key}' is missing`);
  for (const key of lists) if (!Array.isArray(record[key])) throw new Error(`'${key}' is no list`);
  const hasLists = ["robots", "tasks", "capabilities"].every((key) => Array.isArray(record.mission?.[key]));
  if (!hasLists) throw new Error("its mission has no lists of robots, tasks and capabilities");
  try {
    const history = frames(record);
    for (const event of history.events) describeEvent(history, event);
    for (const robot of history.mission.robots.keys()) runsOf(history, robot);
    sceneAt(history, history.last);
  } catch {
    throw new Error(`its ${record.events ? "events" : "steps"} cannot be read`);
  }
}
