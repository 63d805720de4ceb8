// The page while the first plan of a mission is made: the mission as it is drawn, and for how long.

import { App } from "../app.js";
import { recordOfDraft } from "../editor/draft.js";
import { element } from "../panel/dom.js";
import { notifyWork } from "../panel/notice.js";
import { capitalised } from "../record/lengths.js";

export class StartingApp extends App {
  constructor({ mission, text }) {
    super(recordOfDraft(mission));
    this.doing = `${capitalised(text)} …`;
    document.body.classList.add("starting");
    this.options.lines = false;
  }

  start() {
    super.start();
    notifyWork(this.doing);
  }

  downloads() {
    return [element("p", {}, "The mission has not begun.")];
  }

  startText() {
    return "";
  }

  // There is nothing yet but a map.
  look() {
    super.look("map");
  }

  statusText() {
    return "planning";
  }

  // The server has told why the mission cannot be run: back to its drawing.
  hear({ kind }) {
    if (kind === "refused") location.reload();
  }

  address() {
    return "";
  }
}
