// Opens the page of a record.

import { App } from "./app.js";
import { lookInto } from "./look.js";
import { byId } from "./panel/dom.js";

// Of several records the first is shown, the others beside it.
const shown = JSON.parse(byId("record").textContent);
const { compared: [first, ...others], failed } = shown.compared ? shown : { compared: [shown] };
const app = new App(first);
app.start();
if (others.length || failed?.length) app.putBeside(others, failed);
window.teamformer = lookInto(app);
