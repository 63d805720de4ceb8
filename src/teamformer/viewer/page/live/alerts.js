// What an operator of a fleet should know: one list, of which banner, panel and title show parts.

import { act, element } from "../panel/dom.js";
import { capitalised, plural } from "../record/lengths.js";

// The alerts of a state; each has begun at a moment of this page's clock, the same wherever it counts.
export function readAlerts(/** @type {Alert[]} */ alerts, known) {
  return alerts.map((alert) => {
    const same = known.find(({ key, what }) => key === alert.key && what === alert.what);
    return { ...alert, begun: same?.begun ?? performance.now() - 1000 * alert.seconds };
  });
}

// Those that nobody has acknowledged, the latest first.
export function alertsToSee(/** @type {Alert[]} */ alerts) {
  return alerts.filter((alert) => !alert.is_acknowledged).reverse();
}

// What an alert says; the name of a robot or a task stays as it is.
function headOf({ key, what }) {
  return ["all", "end"].includes(key) ? capitalised(what) : what;
}

// For how long an alert has been so, in seconds that go on counting; those who listen hear them once.
function countedSeconds({ begun }) {
  const count = element("span", { "aria-live": "off", "data-begun": String(begun) });
  tellSeconds(count);
  return count;
}

function tellSeconds(count) {
  count.textContent = `${Math.floor((performance.now() - Number(count.dataset.begun)) / 1000)} s`;
}

setInterval(() => document.querySelectorAll("[data-begun]").forEach(tellSeconds), 250);

// The latest alert in the line under the header, with how many more there are.
export function bannerOfAlerts(/** @type {Alert[]} */ alerts) {
  const [latest, ...more] = alertsToSee(alerts);
  if (!latest) return [];
  return [`${headOf(latest)} for `, countedSeconds(latest), more.length ? `; ${plural(more.length, "more alert")}` : ""];
}

// All alerts, the latest first, with a button for each that nobody has acknowledged.
export function alertItems(/** @type {LiveApp} */ app, /** @type {Alert[]} */ alerts) {
  return [...alerts].reverse().map((alert) => {
    const { key, why, do: remedy, since, is_acknowledged: isSeen } = alert;
    const begun = since === null ? "" : `since ${Math.floor(since)} s of the mission, `;
    const acknowledge = () => app.ask({ do: "acknowledge", alert: key });
    return element(
      "li",
      { class: isSeen ? "seen" : "" },
      element("strong", {}, headOf(alert)),
      element("p", { class: "muted" }, begun, "for ", countedSeconds(alert)),
      element("p", {}, `${capitalised(why)}.`),
      element("p", {}, `${capitalised(remedy)}${remedy.endsWith("?") ? "" : "."}`),
      isSeen ? element("p", { class: "muted" }, "Acknowledged") : act("Acknowledge", acknowledge, `acknowledge ${key}`),
    );
  });
}

// Which alerts there are, whatever they count.
export function namesOfAlerts(/** @type {Alert[]} */ alerts) {
  return alerts.map(({ key, what, is_acknowledged: isSeen }) => `${key} ${what} ${isSeen}`).join("\n");
}
