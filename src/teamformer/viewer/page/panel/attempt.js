// What of a record cannot be shown is left out and told once; everything else is shown all the same.

import { notify } from "./notice.js";

const failures = new Set(); // what has been told

// Do something about a part of the page, such as "the map".
export function attempt(part, show) {
  try {
    show();
  } catch (error) {
    tellFailure(part, error);
  }
}

// Draw a part on a canvas, which is then as it was before.
export function attemptOn(/** @type {Canvas2D} */ ctx, part, draw) {
  ctx.save();
  attempt(part, draw);
  ctx.restore();
}

export function messageOf(/** @type {unknown} */ error) {
  return error instanceof Error ? error.message : String(error);
}

function tellFailure(part, error) {
  const text = `Not all of ${part} can be shown: ${messageOf(error)}.`;
  if (failures.has(text)) return;
  failures.add(text);
  console.error(error);
  notify(`${text} Please report it with this record.`);
}
