// The panel of a live mission: how it stands, what it will come to, what happened, a new task.

import { act, allIn, element, link, refill } from "../panel/dom.js";
import { showWork, stopWork, ticking } from "../panel/notice.js";
import { capitalised, describeMoment, describeSpan, shortMoment } from "../record/lengths.js";
import { describeAt } from "../record/words.js";
import { alertItems } from "./alerts.js";

// The fields of the form for each key of a task in a file.
const FIELDS_OF_KEYS = { at: "[name=x], [name=y], [name=place]", needs: ".needs", name: "[name=title]", duration: "[name=duration]" };

const LEAST = 1e-6; // what times differ by that are the same

export class MissionPanel {
  constructor(/** @type {LiveApp} */ app, /** @type {HTMLElement} */ box) {
    this.app = app;
    this.head = element("h2", {});
    this.outlook = element("p", { role: "status", id: "outlook" });
    this.alerts = element("ul", { id: "alerts", "aria-label": "Alerts" });
    this.answer = element("p", { role: "status", id: "answer" });
    this.luck = element("p", { role: "status", id: "luck" });
    this.offer = element("div", { class: "acts", id: "offer" });
    this.planAnew = act("Plan anew, 10 s", () => app.ask({ do: "replan", seconds: 10 }));
    this.incidents = element("ul", { id: "incidents", "aria-label": "Incidents" });
    this.question = element("div", { class: "question", role: "group", "aria-label": "Really?", hidden: "" });
    this.restart = act("Restart …", () => this.askToRestart());
    this.edit = act("Back to the drawing …", () => this.askToEdit());
    this.form = element("form", { id: "new-task", hidden: "" });
    this.form.addEventListener("submit", (event) => this.submit(event));
    box.addEventListener("keydown", (event) => event.key === "Escape" && this.escape(event));
    const acts = element(
      "div",
      { class: "acts" },
      act("New task …", () => this.askForTask(null)),
      this.planAnew,
      act("Save", () => app.ask({ do: "save" })),
      this.restart,
      this.edit,
    );
    box.replaceChildren(this.head, this.alerts, this.outlook, acts, this.question, this.form, this.answer, this.luck, this.offer, this.incidents);
    box.hidden = false;
  }

  show() {
    const { state, player, history } = this.app;
    const isOn = player.isPlaying;
    const running = state.isFleet ? "The fleet" : isOn ? "Live" : "Live, paused";
    const status = history.end.status === "running" ? running : "Live, over";
    const doing = state.planning ? ", planning …" : "";
    const pages = state.watchers > 1 ? `, ${state.watchers} pages` : "";
    this.planAnew.hidden = history.record.method !== "plan" || history.end.status !== "running";
    this.head.replaceChildren(
      element("span", { class: `pulse ${isOn && !state.alerts.length ? "on" : ""}` }),
      `${status}${this.app.isCutOff ? ", connection lost" : doing || pages}`,
    );
    this.showAlerts();
    this.showOutlook();
    this.restart.hidden = state.isFleet === true;
    this.edit.hidden = !state.hasEditor;
    const { world } = history.mission;
    const items = state.incidents.map(([step, text]) => element("li", {}, `${shortMoment(world, step)}: ${text}`));
    if (items.length && !state.isFleet) items[items.length - 1].append(" ", link("Undo", () => this.undo(), "undo"));
    refill(this.incidents, items.reverse()); // the latest first
  }

  // Made anew only if there are others, so that no click is lost.
  showAlerts() {
    const { alerts } = this.app.state;
    if (this.shownAlerts === alerts) return;
    this.shownAlerts = alerts;
    refill(this.alerts, alertItems(this.app, alerts));
  }

  // At once where no step has been made since; else these steps are undone with it.
  undo() {
    const { state, history } = this.app;
    const step = Number(state.undoTo);
    const go = () => this.app.ask({ do: "undo" });
    if (step === this.app.present()) return go();
    const since = describeSpan(history.mission.world, this.app.present() - step);
    this.doubt(`This also undoes the ${since} made since then.`, `Go back to ${describeMoment(history.mission.world, step)}`, go);
  }

  askToRestart() {
    const go = () => this.app.ask({ do: "restart" });
    if (this.hasNothingToLose()) return go();
    this.doubt("What happened since the last save is lost.", "Restart", go);
  }

  askToEdit() {
    const go = () => this.app.ask({ do: "edit" });
    if (this.hasNothingToLose()) return go();
    this.doubt("This mission ends, and what happened since the last save is lost.", "Back to the drawing", go);
  }

  // What is asked, or else the form, goes away; with neither, the selection does.
  escape(/** @type {KeyboardEvent} */ event) {
    if (this.question.hidden && this.form.hidden) return;
    event.stopPropagation();
    if (this.question.hidden) this.close();
    else allIn(this.question, "button")[0].click();
  }

  hasNothingToLose() {
    const { history, state } = this.app;
    return state.savedAt === this.app.present() || (history.last === 0 && !state.incidents.length);
  }

  // A question before what cannot be taken back; the answer that changes nothing comes first.
  doubt(question, yes, go) {
    const before = /** @type {HTMLElement} */ (document.activeElement);
    const answer = (then) => () => {
      this.question.hidden = true;
      then();
    };
    const no = act("No", answer(() => before.isConnected && before.focus()));
    this.question.replaceChildren(element("p", {}, question), element("div", { class: "acts" }, no, act(yes, answer(go))));
    this.question.hidden = false;
    no.focus();
    this.question.scrollIntoView({ block: "nearest" });
  }

  // Another past, or an incident: what was worked out before holds no more.
  forget() {
    this.clear();
    this.ahead = null;
    this.question.hidden = true;
    this.showOutlook();
  }

  // How the mission has ended, or what the server has worked out that it will come to.
  showOutlook() {
    const { state, history } = this.app;
    const { world } = history.mission;
    stopWork(this.outlook);
    if (state.isFleet) this.outlook.textContent = "";
    else if (history.end.status !== "running") this.outlook.textContent = `${capitalised(describeOutcome(world, this.app.outcome()))}.`;
    else if (this.ahead) this.outlook.textContent = `If nothing more happens: ${describeOutcome(world, this.ahead)}.`;
    else showWork(this.outlook, "Working out how it ends …");
  }

  // What the server worked out: the mission's end, or what an incident would make of it.
  tell(message) {
    const { world } = this.app.history.mission;
    if (message.kind === "forecast") {
      this.ahead = message;
      this.app.expect(message.done_at ?? []);
      this.showOutlook();
      return;
    }
    const end = describeOutcome(world, message);
    this.isWeighing = false;
    const more = message.steps - message.without.steps;
    stopWork(this.answer);
    const mean = message.band ? " on average" : "";
    const change = Math.abs(more) < LEAST ? "no later" : `${describeSpan(world, Number(Math.abs(more).toFixed(1)))} ${more > 0 ? "later" : "earlier"}${mean}`;
    this.answer.textContent = `As of ${describeMoment(world, message.at)}, with ${message.text}: ${end}, ${change}.`;
    this.offer.replaceChildren();
    if (message.kind === "offer") this.propose(more);
    else if (message.is_planned) this.weighLuck(more);
    this.answer.scrollIntoView({ block: "nearest" });
  }

  searching({ seconds }) {
    this.showWeighing(`Searching for a better plan for ${seconds} s; the mission waits …`);
  }

  // Plans are searched for, so that a mission may end sooner though a robot is lost.
  weighLuck(more) {
    this.more = more;
    this.showWeighing("Working out how much of this is luck of the search …", this.luck);
  }

  // An incident that can only delay a mission, or only hasten it, does nothing else but by luck.
  tellLuck({ steps, is_luck: isLuck }) {
    this.stopWeighing();
    const by = steps && describeSpan(this.app.history.mission.world, Number(steps.toFixed(1)));
    const others = by ? `Other searches for plans differ by up to ${by}` : "Other searches find plans that end alike";
    const isSure = Math.abs(this.more) > steps;
    const so = isLuck || Math.abs(this.more) < LEAST ? "" : isSure ? ": this is more than luck" : ": this may be luck";
    const ownLuck = this.more < 0 ? "the mission could end as soon without it" : "the mission need not end later by it";
    const parts = [];
    if (isLuck) parts.push(`This is luck of the search: ${ownLuck}.`);
    if (by || (steps === 0 && !isLuck)) parts.push(`${others}${so}.`);
    this.luck.textContent = parts.join(" ");
  }

  // What the server works out beside the mission, for as long as nobody stops it.
  showWeighing(text, /** @type {HTMLElement} */ box = this.answer) {
    if (box === this.answer) this.clear();
    this.isWeighing = true;
    showWork(box, text);
    this.offer.replaceChildren(act("Stop", () => this.app.ask({ do: "stop" })));
  }

  // An answer that is there stays when what it says of luck is stopped.
  stopWeighing() {
    this.isWeighing = false;
    const hasAnswer = ticking.has(this.luck);
    if (!hasAnswer) return this.clear();
    stopWork(this.luck);
    for (const box of [this.luck, this.offer]) box.replaceChildren();
  }

  clear() {
    this.isWeighing = false;
    for (const box of [this.answer, this.luck]) stopWork(box);
    for (const box of [this.answer, this.luck, this.offer]) box.replaceChildren();
  }

  // A plan that would end the mission sooner can be taken over, for as long as nothing goes on.
  propose(more) {
    if (more > -LEAST) {
      this.answer.textContent += " Nothing to gain.";
      return;
    }
    const decide = (take) => () => {
      this.clear();
      if (take) this.app.ask({ do: "take_over" });
    };
    this.offer.replaceChildren(act("Take it over", decide(true)), act("Leave it", decide(false)));
  }

  weigh(incident) {
    this.showWeighing("Playing it ahead …");
    this.app.ask({ do: "what_if", ...incident });
  }

  // The form of a new task, at a place that was clicked or at one to be typed.
  askForTask(at) {
    const { mission } = this.app.history;
    if (this.form.hidden || !this.form.elements.length) this.fill(mission);
    this.form.hidden = false;
    const fields = this.placeFields();
    if (at) [at].flat().forEach((along, number) => (fields[number].value = along));
    this.mark();
    (at ? allIn(this.form, ".needs")[0] : fields[0]).focus({ preventScroll: true });
    this.form.scrollIntoView({ block: "nearest" });
  }

  fill({ capabilities, world }) {
    const number = (name, properties) =>
      element("input", { type: "number", name, step: world.isPlane ? "any" : "1", ...properties });
    const row = (text, input) => element("label", {}, text, input);
    const place = world.roads
      ? [row("Where", element("select", { name: "place" }, ...world.roads.names.map((name) => element("option", { value: name }, name))))]
      : [row("x", number("x", { required: "" })), row("y", number("y", { required: "" }))];
    const needs = capabilities.map((name, cap) =>
      row(name, element("input", { type: "number", class: "needs", name: `cap ${cap}`, min: 0, step: "any", value: 0 })),
    );
    this.form.replaceChildren(
      element("fieldset", {}, element("legend", {}, "Place"), ...place),
      element("fieldset", {}, element("legend", {}, "Needs"), ...needs),
      element(
        "div",
        { class: "pair" },
        row("Name", element("input", { type: "text", name: "title", maxlength: 200, placeholder: "a free name" })),
        row(world.isTimed && !world.secondsUnit ? "Duration" : "Duration, steps", element("input", { type: "number", name: "duration", min: 0, step: this.app.history.isContinuous ? "any" : 1, value: 0 })),
      ),
      element(
        "div",
        { class: "acts" },
        element("button", { type: "submit", class: "switch", "aria-pressed": "true" }, "Add task"),
        this.app.state.isFleet ? "" : act("What would that cost?", () => this.weigh({ task: this.task() })),
        act("Cancel", () => this.close()),
      ),
    );
    for (const field of this.placeFields()) field.addEventListener("input", () => this.mark());
  }

  // Fields for x and y, or one for the name of a place of roads.
  placeFields() {
    return ["x", "y", "place"].map((name) => this.form.elements[name]).filter(Boolean);
  }

  // The place of the form on the map.
  mark() {
    const [x, y] = this.placeFields();
    const { square, roads } = this.app.history.mission.world;
    if (roads) return this.app.select({ place: roads.places[roads.names.indexOf(x.value)] });
    /** @type {Place} */ const place = [Number(x.value) / square, Number(y.value) / square];
    this.app.select(x.value === "" || y.value === "" ? {} : { place });
  }

  task() {
    /** @type {Record<string, any>} */ const { elements } = this.form;
    const { capabilities, world } = this.app.history.mission;
    const counts = capabilities.map((name, cap) => [name, Number(elements[`cap ${cap}`].value)]);
    /** @type {MissionTree} */ const task = {
      at: world.roads ? this.placeFields()[0].value : this.placeFields().map(({ value }) => Number(value)),
      needs: Object.fromEntries(counts.filter(([, count]) => count)),
      duration: Number(elements.duration.value),
    };
    if (elements.title.value.trim()) task.name = elements.title.value.trim();
    return task;
  }

  submit(/** @type {SubmitEvent} */ event) {
    event.preventDefault();
    this.isAdding = true;
    this.app.ask({ do: "happen", task: this.task() });
  }

  // The form stays until its task is in the mission.
  taskIsAdded() {
    if (this.isAdding) this.close();
  }

  // A task that is refused can be mended; the fields of the file's keys that are wrong are marked.
  keepForm(keys) {
    this.isAdding = false;
    if (this.form.hidden) return;
    for (const field of this.form.elements) field.removeAttribute("aria-invalid");
    const wrong = keys.map((key) => FIELDS_OF_KEYS[key] ?? "none").join() || "none";
    const fields = [...this.form.querySelectorAll(wrong)];
    for (const field of fields) field.setAttribute("aria-invalid", "true");
    fields[0]?.focus();
  }

  close() {
    this.isAdding = false;
    this.form.hidden = true;
    this.form.replaceChildren();
    if (!this.isWeighing) this.clear();
    this.app.select({});
    this.app.map.canvas.focus({ preventScroll: true });
  }
}

// How a mission ends, with several futures as a band from a tenth of them to nine tenths.
export function describeOutcome(/** @type {World} */ world, /** @type {Message} */ { status, steps, band, done, futures }) {
  if (band) {
    const [low, high] = band.map((end) => describeMoment(world, end));
    const when = low === high ? describeAt(world, band[0]) : `between ${low} and ${high}`;
    const part = done < futures ? `; in ${futures - done} never` : "";
    return `all done ${when}, in ${Math.round(0.8 * done)} of ${futures} futures${part}`;
  }
  if (status === "completed") return `all done ${describeAt(world, steps)}`;
  if (status === "failed") return "not known: the method failed when it was played ahead";
  if (status === "infeasible") return `given up ${describeAt(world, steps)}, because a task can never be done`;
  return `not done within ${describeSpan(world, steps)}`;
}
