// Building the page: every name from a record goes in as text, never as markup.

import { ringColour, taskColour } from "../draw/palette.js";

/**
 * @template {keyof HTMLElementTagNameMap} Tag
 * @param {Tag} tag
 * @param {Record<string, any>} properties
 * @param {(Node | string | null | undefined)[]} children
 */
export function element(tag, properties = {}, ...children) {
  const node = document.createElement(tag);
  for (const [key, value] of Object.entries(properties)) {
    if (key === "class") node.className = value;
    else if (key === "on") node.addEventListener("click", value);
    else if (key === "colour") node.style.background = value;
    else if (key === "border") node.style.borderColor = value;
    else node.setAttribute(key, value);
  }
  node.append(...children.filter((child) => child !== null && child !== undefined));
  return node;
}

/**
 * A part of `page.html`, which has it.
 * @template {keyof Parts | (string & {})} Id
 * @param {Id} id
 * @returns {Id extends keyof Parts ? Parts[Id] : HTMLElement}
 */
export function byId(id) {
  return /** @type {any} */ (document.getElementById(id));
}

export function link(text, on, key) {
  return element("button", { type: "button", class: "link", on, "data-key": key ?? text }, text);
}

// All elements in a box that a selector says.
/** @returns {any[]} */
export function allIn(/** @type {ParentNode} */ box, /** @type {string} */ selector) {
  return [...box.querySelectorAll(selector)];
}

/** @returns {any} */
export function targetOf(/** @type {Event} */ event) {
  return event.target;
}

// Where a button of the mouse, or a finger, is down, and what is to fill the box around it afterwards.
/** @type {{target: Node | null, then: Map<HTMLElement, (Node | null)[]>}} */
const press = { target: null, then: new Map() };

addEventListener("pointerdown", (event) => (press.target = targetOf(event)), true);
addEventListener("pointerup", () => setTimeout(endPress), true); // the click comes first
addEventListener("pointercancel", endPress, true);

function endPress() {
  press.target = null;
  const waiting = [...press.then];
  press.then.clear();
  for (const [box, nodes] of waiting) refill(box, nodes);
}

// Fill a box anew; what had the focus keeps it, and fields what is typed in them, if they are still there.
// A box that is being pressed waits: a click counts only where what was pressed is what is let go.
export function refill(/** @type {HTMLElement} */ box, nodes) {
  if (press.target && box.contains(press.target)) {
    press.then.set(box, nodes);
    return;
  }
  const focused = /** @type {HTMLElement} */ (document.activeElement);
  const key = box.contains(focused) ? focused.dataset.key : undefined;
  const typed = typedIn(box);
  box.replaceChildren(...nodes.filter(Boolean));
  for (const input of allIn(box, "input[data-key]")) {
    input.value = typed.get(input.dataset.key) ?? input.value;
  }
  if (key === undefined) return;
  const again = allIn(box, "[data-key]").find((node) => node.dataset.key === key);
  if (again?.tabIndex === -1) moveStop(again);
  again?.focus({ preventScroll: true });
}

// What stands in fields and has not been sent, by their keys.
function typedIn(/** @type {HTMLElement} */ box) {
  const changed = allIn(box, "input[data-key]").filter(({ value, defaultValue }) => value !== defaultValue);
  return new Map(changed.map(({ dataset, value }) => [dataset.key, value]));
}

// Make the buttons of a list one stop of the Tab key; up and down go from one to the next.
export function oneStop(list) {
  const buttons = () => allIn(list, "button");
  list.dataset.stops = "one";
  buttons().forEach((button, number) => (button.tabIndex = number ? -1 : 0));
  list.addEventListener("keydown", (event) => {
    const by = { ArrowUp: -1, ArrowDown: 1 }[event.key];
    const all = buttons().filter((button) => button.offsetParent);
    const next = by && all[all.indexOf(event.target) + by];
    if (!next) return;
    event.preventDefault();
    event.stopPropagation();
    moveStop(next);
    next.focus();
  });
  return list;
}

// Have Tab lead to another button of a list made by `oneStop`.
function moveStop(button) {
  const list = button.closest("[data-stops]");
  for (const other of list?.querySelectorAll("button[tabindex='0']") ?? []) other.tabIndex = -1;
  button.tabIndex = 0;
}

const unfolded = new Set();

// A part that opens and closes, and stays as it was when its box is filled anew.
function foldout(key, title, content) {
  const node = element("details", {}, element("summary", { "data-key": key }, title), content);
  node.open = unfolded.has(key);
  node.addEventListener("toggle", () => (node.open ? unfolded.add(key) : unfolded.delete(key)));
  return node;
}

// A coloured disc with a capability's short label.
export function swatch(/** @type {App} */ app, cap) {
  const { fill, ink } = app.colours[cap];
  const node = element("span", { class: "swatch", colour: fill, "aria-hidden": "true" }, app.labels[cap]);
  node.style.color = ink;
  return node;
}

export function teamMark(/** @type {App} */ app, /** @type {Team} */ team) {
  return mark("mark", ringColour(team, app.map.isDark, app.options.rings));
}

export function taskMark(/** @type {App} */ app, task) {
  return mark("mark square", taskColour(task, app.map.isDark));
}

export function mark(kind, border) {
  return element("span", { class: kind, border, "aria-hidden": "true" });
}

// A list of which only the first are shown until the rest is asked for.
export function foldedList(key, kind, items, shown) {
  const list = (part) => element(kind === "chips" ? "div" : "ul", { class: kind }, ...part);
  if (items.length <= shown + 2) return list(items);
  const rest = foldout(key, `${items.length - shown} more`, list(items.slice(shown)));
  return element("div", {}, list(items.slice(0, shown)), rest);
}

export function titled(title, content) {
  return [element("h3", {}, title), content];
}

export function act(text, on, key) {
  return element("button", { type: "button", on, "data-key": key }, text);
}
