// What one can do with the page of a plan, which holds the plan as JSON: select, link, save as CSV.

import { allIn, byId, targetOf } from "../panel/dom.js";
import { csvOf, download, fileName } from "../panel/saving.js";

const plan = JSON.parse(byId("plan").textContent);
/** @type {{task?: string, robot?: string}} */ let chosen = {};

function select(/** @type {{task?: string, robot?: string}} */ selection) {
  chosen = selection;
  const { task, robot } = chosen;
  const isChosen = ({ dataset }) => (task !== undefined ? dataset.task === task : dataset.robot === robot);
  const isAny = task !== undefined || robot !== undefined;
  document.body.classList.toggle("chosen", isAny);
  for (const node of allIn(document, "[data-task], [data-robot]")) node.classList.toggle("now", isAny && isChosen(node));
  byId("said").textContent = describe();
  const address = new URLSearchParams(chosen).toString();
  if (location.protocol !== "about:") window.history.replaceState(null, "", `#${address}`); // in a frame it has none
}

function describe() {
  const { task, robot } = chosen;
  if (task !== undefined) return `${task}: ${describeTask(task)}`;
  if (robot === undefined) return "Click a task or a robot to see when it does what.";
  const { stops, back } = plan.routes.find((route) => route.robot === robot);
  const told = stops.map(({ task: name, start, end }) => `${name} from ${start} to ${end}`);
  return `${robot}: ${[...told, `back at ${back}`].join(", ")}`;
}

function describeTask(task) {
  const doers = plan.routes.filter(({ stops }) => stops.some((stop) => stop.task === task));
  const { start, end } = doers[0].stops.find((stop) => stop.task === task);
  const there = doers.map(({ robot, stops }) => `${robot} there at ${stops.find((stop) => stop.task === task).arrive}`);
  const window = plan.windows?.[task];
  const parts = [...there, `from ${start} to ${end}`];
  if (window) parts.push(`to be done between ${window[0]} and ${window[1]}`);
  if (plan.late[task]) parts.push(`late by ${plan.late[task]}`);
  return parts.join(", ");
}

// A line for each task of each robot.
function tableOfStops() {
  const rows = plan.routes.flatMap(({ robot, stops }) =>
    stops.map(({ task, arrive, start, end }) => [robot, task, arrive, start, end, ...(plan.windows?.[task] ?? ["", ""]), plan.late[task] ?? ""]),
  );
  return [["robot", "task", "there", "begin", "end", "not_before", "due", "late_by"], ...rows];
}

function readAddress() {
  const wanted = new URLSearchParams(location.hash.slice(1));
  const [task, robot] = ["task", "robot"].map((key) => wanted.get(key) ?? undefined);
  const isDone = (route) => route.stops.some((stop) => stop.task === task);
  if (plan.routes.some(isDone)) select({ task });
  else if (plan.routes.some((route) => route.robot === robot)) select({ robot });
  else select({});
}

document.addEventListener("click", (event) => {
  const target = targetOf(event);
  const node = target.closest("[data-task], [data-robot]");
  if (node) select(node.dataset.task === undefined ? { robot: node.dataset.robot } : { task: node.dataset.task });
  else if (target.closest(".times")) select({});
});
document.addEventListener("keydown", ({ key }) => key === "Escape" && select({}));
addEventListener("hashchange", readAddress);
byId("save").addEventListener("click", () => download(csvOf(tableOfStops()), `${fileName(plan.mission)}-plan.csv`));
byId("save").hidden = false;
readAddress();
