// The map: a canvas as large as its box that shows a moment and knows what is under a pixel.

import { attemptOn } from "../panel/attempt.js";
import { sitesAt } from "../record/history.js";
import { standingOf } from "../record/scene.js";
import { Camera } from "./camera.js";
import { drawAssignments, drawMessages, drawOrder, drawSelection, drawTrails } from "./extras.js";
import { detailAt, drawTeams, groupUnder } from "./groups.js";
import { drawCrowdLegend } from "./legend.js";
import { drawNames } from "./names.js";
import { blendPlaces, placeEverybody } from "./placing.js";
import { lazily, onto, penOf, robotSpot } from "./shapes.js";
import { drawDestinations, drawRegions, drawTasks, partTasks, taskBox } from "./tasks.js";
import { drawWorld } from "./world.js";

const THEME = [
  ...["paper", "surface", "ground", "grid", "wall", "edge", "line", "ink", "muted", "faint"],
  ...["accent", "soft", "good", "bad", "lost", "wait", "form", "load", "carry", "task"],
];

export class TrialMap {
  /** @type {Camera} */ camera;
  /** @type {View} */ shown; // as drawn last
  /** @type {Theme} */ theme;

  constructor(/** @type {Shown} */ app, /** @type {HTMLCanvasElement} */ canvas) {
    this.app = app;
    this.canvas = canvas;
    /** @type {Map<Scene, Places>} */ this.placed = new Map(); // at one zoom
    /** @type {Map<string, HTMLCanvasElement>} */ this.images = new Map(); // of tasks, at one zoom
    /** @type {{key: string, canvas: HTMLCanvasElement, changing: number[]} | null} */ this.still = null;
    this.keptFor = "";
    this.width = this.height = 0; // pixels; none until it is seen
    this.above = 0; // pixels over the map that stay free
    this.frames = 0;
    this.readTheme();
    new ResizeObserver(() => this.resize()).observe(canvas);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
      this.readTheme();
      app.redraw();
    });
  }

  // Another world from now on.
  look(/** @type {World} */ world) {
    this.camera = new Camera(world);
    this.above = 0;
    if (this.width) this.camera.fit(this.width, this.height);
    this.placed.clear();
    this.images.clear();
    this.still = null;
  }

  readTheme() {
    const style = getComputedStyle(document.documentElement);
    this.theme = Object.fromEntries(THEME.map((n) => [n, style.getPropertyValue(`--${n}`).trim()]));
    this.theme.font = getComputedStyle(document.body).fontFamily;
    this.isDark = matchMedia("(prefers-color-scheme: dark)").matches;
  }

  resize() {
    const { width, height } = this.canvas.getBoundingClientRect();
    if (!width || !height) return; // it is hidden; others may see through the same camera
    const sharpness = window.devicePixelRatio || 1;
    this.width = width;
    this.height = height;
    this.above = 0;
    this.canvas.width = Math.round(width * sharpness);
    this.canvas.height = Math.round(height * sharpness);
    if (this.camera?.isFitted) this.camera.fit(width, height, this.above);
    this.app.redraw();
  }

  fit() {
    this.camera.fit(this.width, this.height, this.above);
    this.app.redraw();
  }

  zoom(factor, x = this.width / 2, y = this.height / 2) {
    this.camera.zoom(factor, x, y);
    this.app.redraw();
  }

  pan(right, down) {
    this.camera.pan(right, down);
    this.app.redraw();
  }

  draw() {
    if (!this.width) return;
    const view = this.viewNow();
    view.ctx.setTransform(view.sharpness, 0, 0, view.sharpness, 0, 0);
    view.ctx.fillStyle = view.theme.paper; // all of it, so that pictures and videos have a ground
    view.ctx.fillRect(0, 0, this.width, this.height);
    const still = this.stillLayer(view);
    view.ctx.drawImage(still.canvas, 0, 0, this.width, this.height);
    const layer = (part, draw) => attemptOn(view.ctx, part, () => draw(view));
    if (view.options.trails) layer("the trails", drawTrails);
    if (view.options.order) layer("the order", drawOrder);
    if (view.options.messages) layer("the messages", drawMessages);
    layer("where loads go", drawDestinations);
    drawTasks(view, still.changing);
    layer("the lines to tasks", drawAssignments);
    layer("the robots", drawTeams);
    layer("the selection", drawSelection);
    layer("the names", drawNames);
    this.shown = view;
    this.frames++;
    const legend = drawCrowdLegend(view);
    if (legend > this.above) this.makeRoom(legend);
  }

  // A map that is fitted lies under the legend of its crowds.
  makeRoom(above) {
    this.above = above;
    if (!this.camera.isFitted) return;
    this.camera.fit(this.width, this.height, above);
    this.draw();
  }

  // What stands still between two steps, drawn once for both: {canvas, changing}, the ground with
  // the tasks around which nothing moves, and the tasks that are left.
  stillLayer(/** @type {View} */ view) {
    const { camera, scene, part, sharpness } = view;
    const where = [camera.left, camera.top, this.width, this.height].join(" ");
    const key = `${this.keptFor} ${where} ${scene.step} ${part > 0} ${view.history.last} ${view.options.dim}`;
    if (this.still?.key === key) return this.still;
    const canvas = this.still?.canvas ?? document.createElement("canvas");
    canvas.width = this.canvas.width;
    canvas.height = this.canvas.height;
    const ctx = penOf(canvas);
    ctx.setTransform(sharpness, 0, 0, sharpness, 0, 0);
    const [still, changing] = partTasks(view);
    attemptOn(ctx, "the world", () => drawWorld(onto(view, ctx)));
    attemptOn(ctx, "the regions", () => drawRegions(onto(view, ctx)));
    drawTasks(onto(view, ctx), still);
    this.still = { key, canvas, changing };
    return this.still;
  }

  // All that the drawing functions need to know of this moment.
  viewNow() {
    const { app, camera } = this;
    const { history } = app;
    const sharpness = this.canvas.width / this.width;
    this.forgetUnless(`${camera.cell} ${sharpness} ${this.isDark}`);
    const scene = app.scene();
    const part = scene.step < history.last ? app.player.part : 0;
    /** @type {any} */ const view = {
      ctx: penOf(this.canvas),
      width: this.width,
      height: this.height,
      camera,
      history,
      scene,
      sceneAfter: part > 0 ? app.sceneAt(scene.step + 1) : scene,
      detail: detailAt(history.mission, camera.cell),
      part,
      sharpness,
      images: this.images,
      mission: history.mission,
      sites: sitesAt(history, scene.step),
      theme: this.theme,
      isDark: this.isDark,
      colours: app.colours,
      labels: app.labels,
      options: app.options,
      selection: app.selection,
      selectedTeam: app.selectedTeam(),
    };
    return this.withPlaces(view);
  }

  // Where each robot is drawn is worked out when it is asked for: crowds do without.
  withPlaces(/** @type {View} */ view) {
    const { scene, part } = view;
    lazily(view, "places", () => this.placesAt(scene.step));
    lazily(view, "placesAfter", () => (part > 0 ? this.placesAt(scene.step + 1) : view.places));
    lazily(view, "blended", () => blendPlaces(view.places, view.placesAfter, part));
    return view;
  }

  // What was worked out for another zoom or theme is of no use.
  forgetUnless(key) {
    if (this.keptFor === key) return;
    this.keptFor = key;
    this.placed.clear();
    this.images.clear();
  }

  placesAt(step) {
    const scene = this.app.sceneAt(step);
    if (this.placed.size > 8) this.placed.clear();
    if (!this.placed.has(scene)) {
      this.placed.set(scene, placeEverybody(this.app.history, scene, this.camera.cell));
    }
    return this.placed.get(scene);
  }

  // What is under a pixel, if anything is.
  /** @returns {Thing} */
  thingAt(x, y) {
    const view = this.shown;
    if (view.detail !== "robots") return groupUnder(view, x, y) ?? taskUnder(view, x, y) ?? {};
    return robotUnder(view, x, y) ?? taskUnder(view, x, y) ?? {};
  }
}

function robotUnder(/** @type {View} */ view, x, y) {
  /** @type {Thing | null} */ let best = null;
  let nearest = Infinity;
  for (let robot = 0; robot < view.mission.robots.length; robot++) {
    const spot = robotSpot(view, robot);
    const away = Math.hypot(spot.x - x, spot.y - y);
    if (away > Math.max(spot.r * 1.2, 5) || away >= nearest) continue;
    nearest = away;
    best = { robot };
  }
  return best;
}

function taskUnder(/** @type {View} */ view, x, y) {
  const task = view.mission.tasks.findIndex((_, number) => {
    if (standingOf(view.history, number, view.scene.step) === "hidden") return false;
    const box = taskBox(view, number);
    return Math.max(Math.abs(box.x - x), Math.abs(box.y - y)) <= box.half + 2;
  });
  return task < 0 ? null : { task };
}
