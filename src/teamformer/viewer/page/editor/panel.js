// The editor's panel: Run, tools, the fields of what is selected, what a new thing brings, problems.

import { act, allIn, byId, element, link } from "../panel/dom.js";
import { notifyWork } from "../panel/notice.js";
import { kindOf, numberOf, readWrittenCounts, sizeOfWorld, withChange, withName, withSize, writtenCounts } from "./draft.js";

const TOOLS = { move: "Select", robot: "Robot", task: "Task", wall: "Wall", erase: "Erase" };

export class EditorPanel {
  constructor(/** @type {EditorApp} */ app, /** @type {HTMLElement} */ box) {
    this.app = app;
    this.kits = { robots: {}, tasks: {} }; // what a new one brings or needs, by capability
    this.tools = new Map(Object.entries(TOOLS).map(([name, text]) => [name, this.toolButton(name, text)]));
    this.world = element("form", { class: "world" });
    this.thing = element("form", { id: "thing", hidden: "" });
    this.problems = element("ul", { class: "problems", id: "problems", "aria-label": "Problems" });
    this.file = element("input", { type: "text", id: "file-name", value: "mission.yaml", "aria-label": "File name" });
    this.kitBox = element("fieldset", { id: "kit" });
    this.undo = act("Undo", () => app.undo());
    this.redo = act("Redo", () => app.redo());
    box.replaceChildren(
      element("h2", {}, "Draw a mission"),
      element("button", { type: "button", class: "run", on: () => this.run() }, playSign(), "Run the mission"),
      element("div", { class: "tools-row", role: "group", "aria-label": "Tools" }, ...this.tools.values()),
      element("div", { role: "status" }, this.problems),
      this.thing,
      this.kitBox,
      element(
        "div",
        { class: "acts" },
        this.undo,
        this.redo,
        act("New", () => app.askToOpen({ do: "new" })),
        act("Open …", () => this.openFile()),
        this.file,
        act("Save", () => app.askWithDrawing({ do: "save", name: this.file.value.trim() })),
      ),
      this.world,
    );
    for (const form of [this.world, this.thing]) {
      form.addEventListener("submit", (event) => event.preventDefault());
    }
    box.hidden = false;
    this.fill();
    this.showTools();
    this.showHistory();
  }

  // Only what there is can be undone, or done again.
  showHistory() {
    const { before, after } = this.app.draft;
    this.undo.disabled = !before.length;
    this.redo.disabled = !after.length;
  }

  run() {
    notifyWork("Getting the mission ready …");
    this.app.askWithDrawing({ do: "run" });
  }

  toolButton(name, text) {
    const on = () => this.app.useTool(name);
    return element("button", { type: "button", class: "switch", "data-tool": name, on }, text);
  }

  showTools() {
    for (const [name, button] of this.tools) {
      button.setAttribute("aria-pressed", String(name === this.app.tool));
    }
    this.fillKit();
  }

  // The fields of the mission itself.
  fill() {
    const { tree } = this.app.draft;
    const change = (make) => (event) => this.app.change(make(event.target), {}, event.target.name);
    /** @type {HTMLElement[]} */ const fields = [
      labelled("Name", input("text", "name", tree.name ?? "", change(({ value }) => ({ ...this.tree(), name: value }))), "wide"),
      labelled("Capabilities", input("text", "capabilities", tree.capabilities.join(", "), (event) => this.renameCapabilities(event)), "wide"),
    ];
    if (!tree.world.plane) {
      const [width, height] = sizeOfWorld(tree.world);
      const resize = () => {
        const [x, y] = ["width", "height"].map((key) => Number(this.world.elements[key].value));
        if (x >= 1 && y >= 1 && x * y <= 250_000) this.app.change(withSize(this.tree(), x, y), {}, "size");
      };
      fields.push(
        element("fieldset", {}, element("legend", {}, "Cells"), labelled("across", number("width", width, resize)), labelled("up", number("height", height, resize))),
      );
    }
    this.world.replaceChildren(...fields);
    this.fillKit();
    this.showThing();
  }

  // What the next robot brings, or the next task needs, for as long as one draws these.
  fillKit() {
    const kind = `${this.app.tool}s`;
    const kit = this.kits[kind];
    this.kitBox.hidden = !kit;
    if (!kit) return;
    const rows = this.tree().capabilities.map((name, cap) => {
      kit[name] ??= cap === 0 ? 1 : 0;
      const keep = ({ target }) => (kit[name] = Number(target.value));
      return labelled(name, number(`kit ${name}`, kit[name], keep, "any"));
    });
    const title = kind === "robots" ? "A new robot brings" : "A new task needs";
    this.kitBox.replaceChildren(element("legend", {}, title), ...rows);
  }

  // What a new thing of a kind has, by capability.
  kit(kind) {
    return Object.fromEntries(this.tree().capabilities.map((name) => [name, this.kits[kind][name] ?? 0]));
  }

  renameCapabilities({ target }) {
    const capabilities = target.value.split(",").map((name) => name.trim()).filter(Boolean);
    this.app.change({ ...this.tree(), capabilities }, {}, "capabilities");
    this.fillKit();
  }

  // The fields of what is selected; they stay as they are while one types in them.
  showThing() {
    const { selection, draft } = this.app;
    const isThing = selection.robot !== undefined || selection.task !== undefined;
    const thing = isThing ? draft.tree[kindOf(selection)][numberOf(selection)] : null;
    this.thing.hidden = !thing;
    if (!thing) return this.thing.replaceChildren();
    if (this.thing.contains(document.activeElement)) return;
    const kind = kindOf(selection);
    const set = (make, key) => ({ target }) =>
      this.app.change(withChange(this.tree(), selection, make(target)), selection, `${key} ${kind} ${numberOf(selection)}`);
    const place = () => ["x", "y"].map((name) => Number(this.thing.elements[name].value));
    const key = kind === "robots" ? "can" : "needs";
    const counts = readWrittenCounts(thing[key] ?? []);
    const all = () =>
      writtenCounts(Object.fromEntries(draft.tree.capabilities.map((name) => [name, Number(this.thing.elements[`count ${name}`].value)])));
    const more = FILE_KEYS[kind]
      .filter(({ name, field }) => field !== "number" || typeof (thing[name] ?? 0) !== "object") // a range is kept
      .map((key) => this.keyField(key, thing, set));
    this.thing.replaceChildren(
      labelled(kind === "robots" ? "Robot" : "Task", input("text", "title", thing.name ?? "", ({ target }) => this.rename(selection, target.value)), "wide"),
      element(
        "fieldset",
        {},
        element("legend", {}, kind === "robots" ? "Brings" : "Needs"),
        ...draft.tree.capabilities.map((name) => labelled(name, number(`count ${name}`, counts[name] ?? 0, set(() => ({ [key]: all() }), key), "any"))),
      ),
      element("fieldset", {}, element("legend", {}, "Place"), labelled("x", number("x", thing.at[0], set(() => ({ at: place() }), "at"), "any")), labelled("y", number("y", thing.at[1], set(() => ({ at: place() }), "at"), "any"))),
      ...more,
      element("div", { class: "acts" }, act("Remove", () => this.app.remove(selection))),
    );
  }

  // The field of a key, by what stands under it.
  keyField({ name, label, help, field }, /** @type {Thing} */ thing, set) {
    const value = thing[name];
    const change = (read) => set((target) => ({ [name]: read(target) }), name);
    const made = {
      number: () => number(name, value ?? "", change(({ value }) => (value === "" ? undefined : Number(value))), "any"),
      steps: () => input("text", name, [value ?? []].flat().join(", "), change(({ value }) => readSteps(value))),
      text: () => input("text", name, value ?? "", change(({ value }) => value || undefined)),
      flight: () => checkbox(name, value === "air", change(({ checked }) => (checked ? "air" : undefined))),
    }[field]();
    made.title = help;
    return labelled(label, made, field === "text" ? "wide" : "");
  }

  // Letter by letter, each from what was before the first: half a name may be another thing's.
  rename(/** @type {Thing} */ thing, name) {
    const key = `name ${kindOf(thing)} ${numberOf(thing)}`;
    this.app.change(withName(this.app.draft.beforeChanges(key), thing, name), thing, key);
  }

  // What the file reader says; each leads to what it is about. What is still to be drawn is no fault.
  tell(problems) {
    const isToCome = ([kind, ...rest]) => !rest.length && this.tree()[kind]?.length === 0;
    const items = problems.map(({ where, message }) => {
      const [kind, index] = where;
      const thing = { robots: { robot: index }, tasks: { task: index } }[kind];
      const isThing = thing && Number.isInteger(index);
      return element("li", { class: isToCome(where) ? "hint" : "" }, isThing ? link(message, () => this.app.select(thing)) : message);
    });
    this.problems.replaceChildren(...items);
  }

  tree() {
    return this.app.draft.tree;
  }

  openFile() {
    const accept = ".yaml,.yml,.json,.map,.pgm,.png,.jpg,.jpeg,.bmp";
    const field = element("input", { type: "file", accept, multiple: "" });
    field.addEventListener("change", () => this.send([...(field.files ?? [])]));
    field.click();
  }

  // A mission or a map, and what it names if that was chosen with it: a map, or a map's image.
  async send(files) {
    notifyWork("Reading …");
    const read = await Promise.all(files.map(async (file) => ({ file, text: await file.text() })));
    const isText = ({ file }) => /\.(ya?ml|json|map)$/i.test(file.name);
    const { file, text } = read.find(isMission) ?? read.find(isText) ?? read[0];
    const beside = {};
    for (const other of files) if (other !== file) beside[other.name] = await inBase64(other);
    this.app.askToOpen({ do: "open", name: file.name, text, beside });
  }
}

// One step, or a list of them: `9` or `9, 40`; what is no number is left for the file reader to say.
function readSteps(text) {
  const steps = text.split(",").map((part) => part.trim()).filter(Boolean);
  const read = steps.map((step) => (Number.isNaN(Number(step)) ? step : Number(step)));
  return read.length > 1 ? read : read[0];
}

function playSign() {
  return allIn(byId("start"), "svg")[0].cloneNode(true);
}

function isMission({ text }) {
  return /^["{\s]*teamformer\b/m.test(text);
}

async function inBase64(file) {
  const bytes = new Uint8Array(await file.arrayBuffer());
  let text = "";
  for (let at = 0; at < bytes.length; at += 8192) text += String.fromCharCode(...bytes.subarray(at, at + 8192));
  return btoa(text);
}

function labelled(text, field, kind = "") {
  return element("label", { class: kind }, text, field);
}

function input(type, name, value, on) {
  const field = element("input", { type, name, value });
  field.addEventListener("input", on);
  return field;
}

function checkbox(name, isChecked, on) {
  const field = input("checkbox", name, "on", on);
  field.checked = isChecked;
  return field;
}

function number(name, value, on, /** @type {number | "any"} */ step = 1) {
  const field = element("input", { type: "number", name, value, min: 0, step });
  field.addEventListener("input", on);
  return field;
}
