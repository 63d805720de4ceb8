// The line under the header, and boxes that show that something is being worked on.

const ticking = new WeakMap(); // by box, the timer of its seconds

// What went wrong; with "good" what went well, with "plain" what has happened.
function notify(text, kind = "") {
  stopWork(byId("notice"));
  byId("notice").textContent = text;
  byId("notice").className = `notice ${kind}`;
  byId("notice").hidden = !text;
}

// What is being worked on, until the next notice.
function notifyWork(text) {
  notify(text, "plain");
  showWork(byId("notice"), text);
}

// A text with a sign that moves and, after a second, for how long it has been so; those who listen
// hear the text once. It stays until `stopWork`.
function showWork(box, text) {
  stopWork(box);
  const seconds = element("span", { "aria-hidden": "true" });
  const sign = element("span", { class: "working", "aria-hidden": "true" });
  box.replaceChildren(sign, text, seconds);
  const begun = performance.now();
  const tell = () => (seconds.textContent = ` ${Math.round((performance.now() - begun) / 1000)} s`);
  ticking.set(box, setInterval(tell, 1000));
}

function stopWork(box) {
  clearInterval(ticking.get(box));
}
