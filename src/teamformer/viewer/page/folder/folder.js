// What one can do with the page of a folder: sort its table, and look at several records side by side.

import { allIn, byId, element, targetOf } from "../panel/dom.js";

/** @type {HTMLElement} */ const rows = document.querySelector("tbody");
const shown = byId("shown");

// By the values of a column; again by the same one turns the order round. What has no value comes last.
function sortBy(/** @type {HTMLElement} */ button) {
  const head = button.closest("th");
  const isTurned = head.getAttribute("aria-sort") === "ascending";
  for (const other of allIn(document, "th")) other.removeAttribute("aria-sort");
  head.setAttribute("aria-sort", isTurned ? "descending" : "ascending");
  const column = [...head.parentElement.children].indexOf(head);
  const sorted = [...rows.children].sort((one, other) => {
    const [a, b] = [valueOf(one, column), valueOf(other, column)];
    if (a === "" || b === "") return Number(a === "") - Number(b === "");
    const difference = typeof a === "number" && typeof b === "number" ? a - b : String(a).localeCompare(String(b));
    return isTurned ? -difference : difference;
  });
  rows.append(...sorted);
}

function valueOf(/** @type {Element} */ row, /** @type {number} */ column) {
  const text = row.children[column]?.textContent.trim() ?? ""; // what cannot be read has fewer cells
  return text === "" || Number.isNaN(Number(text)) ? text : Number(text);
}

// A frame for each record that is ticked, in the order of the table.
function showTicked() {
  const ticked = allIn(document, "input:checked").map((box) => /** @type {HTMLInputElement} */ (box));
  const kept = new Map(allIn(shown, "iframe").map((frame) => [frame.getAttribute("src"), frame]));
  const frames = ticked.map(({ value, title }) => kept.get(value) ?? element("iframe", { src: value, title }));
  for (const [, frame] of kept) if (!frames.includes(frame)) frame.remove();
  shown.append(...frames.filter((frame) => !frame.isConnected));
  shown.hidden = frames.length === 0;
}

document.addEventListener("click", (event) => {
  const button = targetOf(event).closest("th button");
  if (button) sortBy(/** @type {HTMLElement} */ (button));
});
document.addEventListener("change", showTicked);
