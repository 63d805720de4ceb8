// Opens the page of a live mission: once the server has told how it stands.

import { EditorApp } from "../editor/app.js";
import { lookInto } from "../look.js";
import { byId } from "../panel/dom.js";
import { notify, showSeconds, stopWork } from "../panel/notice.js";
import { HOW_TO_RESUME, LiveApp } from "./app.js";
import { Link } from "./link.js";
import { StartingApp } from "./starting.js";

// What each first word of the server makes of the page.
const APPS = {
  mission: ({ record, now }) => new LiveApp({ ...record, now }, server),
  editor: (message) => new EditorApp(message, server),
  starting: (message) => new StartingApp(message),
};

const GONE = "teamformer mission is gone"; // the key in what the browser keeps for this tab

/** @type {any} */ let app = null;
let opening = null; // the word that the page was opened by
const server = new Link(hearServer, (isOpen) => {
  showCutOff(!isOpen);
  if (!app) return;
  app.isCutOff = !isOpen;
  app.isBehind ||= !isOpen;
  app.panel?.show?.();
});

// Says for how long the server has not been there, until it is again.
function showCutOff(isCutOff) {
  const box = byId("cut-off");
  if (box.hidden !== isCutOff) return;
  box.hidden = !isCutOff;
  document.body.classList.toggle("is-cut-off", isCutOff);
  const after = " ago. What you see may be outdated, and nothing that you ask for is done. Trying again …";
  if (isCutOff) showSeconds(box, { before: "Cut off: the connection to the server was lost ", seconds: 0, after });
  else stopWork(box);
}

function hearServer(message) {
  const { kind } = message;
  if (kind === "begun") return location.reload(); // there is another mission, or a drawing
  if (app) return isOther(kind) ? comeToOther() : app.hear(message);
  if (!APPS[kind]) return;
  opening = kind;
  app = APPS[kind](message);
  app.start();
  document.title = `${app.history.mission.name}, live`;
  app.hear(message);
  tellWhatIsGone();
  window.teamformer = lookInto(app);
}

// The page loads anew, and then says why where a mission is gone.
function comeToOther() {
  if (opening === "mission") sessionStorage.setItem(GONE, "true");
  location.reload();
}

function tellWhatIsGone() {
  if (sessionStorage.getItem(GONE)) notify(`The mission that was here has ended or was cut off. ${HOW_TO_RESUME}`);
  sessionStorage.removeItem(GONE);
}

// While the line was down, the server has gone on to something else.
function isOther(kind) {
  return kind in APPS && kind !== opening && !(kind === "starting" && opening === "editor");
}
