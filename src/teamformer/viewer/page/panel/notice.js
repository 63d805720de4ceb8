// The line under the header, and boxes that show that something is being worked on.

import { byId, element } from "./dom.js";

export const ticking = new WeakMap(); // by box, the timer of its seconds

const NOTICE_STAYS = 8000; // milliseconds, of one that is not bad

/** @type {number | undefined} */ let noticeTimer;

// What went wrong, which stays until it is closed; for a while, with "good" what went well, with
// "plain" what has happened.
export function notify(text, kind = "") {
  stopWork(byId("notice"));
  clearTimeout(noticeTimer);
  byId("notice").textContent = text;
  byId("notice-box").className = `notice ${kind}`;
  byId("notice-box").hidden = !text;
  if (kind) noticeTimer = setTimeout(() => notify(""), NOTICE_STAYS);
}

// What is being worked on, until the next notice.
export function notifyWork(text) {
  notify(text, "plain");
  clearTimeout(noticeTimer);
  showWork(byId("notice"), text);
}

// What is wrong, as texts and elements.
export function notifyParts(parts) {
  notify(" ");
  byId("notice").replaceChildren(...parts);
}

// A text with a sign that moves and, after a second, for how long it has been so; those who listen
// hear the text once. It stays until `stopWork`.
export function showWork(/** @type {HTMLElement} */ box, text) {
  stopWork(box);
  const seconds = element("span", { "aria-hidden": "true" });
  const sign = element("span", { class: "working", "aria-hidden": "true" });
  box.replaceChildren(sign, text, seconds);
  const begun = performance.now();
  const tell = () => (seconds.textContent = ` ${Math.round((performance.now() - begun) / 1000)} s`);
  ticking.set(box, setInterval(tell, 1000));
}

// A text with seconds that go on counting from so many; those who listen hear it once.
export function showSeconds(/** @type {HTMLElement} */ box, { before, seconds, after }) {
  stopWork(box);
  const count = element("span", { "aria-live": "off" }, String(seconds));
  box.replaceChildren(before, count, ` s${after}`);
  const begun = performance.now() - 1000 * seconds;
  const tell = () => (count.textContent = String(Math.round((performance.now() - begun) / 1000)));
  ticking.set(box, setInterval(tell, 1000));
}

export function stopWork(/** @type {HTMLElement} */ box) {
  clearInterval(ticking.get(box));
  ticking.delete(box);
}
