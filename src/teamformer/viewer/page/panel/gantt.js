// The Gantt view: robots down, time across, what each does, and which share of it is idle.

const ROW_HEIGHT = 22; // pixels; less where there are many robots
const LEAST_ROW_HEIGHT = 7;
const NAME_WIDTH = 96;
const SHARE_WIDTH = 54;
const AXIS_HEIGHT = 24;
const NAMED_ROWS_FROM = 12; // pixels a row

const PHASE_COLOURS = {
  walks: "accent",
  waits: "wait",
  forms: "form",
  serves: "good",
  idle: "line",
  lost: "bad",
};
class Gantt {
  constructor(app, canvas) {
    this.app = app;
    this.canvas = canvas;
    this.box = canvas.parentElement.parentElement;
    this.box.addEventListener("scroll", () => this.app.redraw());
    new ResizeObserver(() => this.app.redraw()).observe(this.box);
    canvas.addEventListener("click", (event) => this.click(event));
    canvas.addEventListener("keydown", (event) => this.press(event));
  }

  // Another record, or another length of this one.
  forget() {
    this.runs = null;
    this.shares = null;
  }

  // Up and down go from robot to robot; the other keys are the page's own.
  press(event) {
    const by = { ArrowUp: -1, ArrowDown: 1 }[event.key];
    if (!by) return;
    event.preventDefault();
    const { length } = this.app.history.scenario.robots;
    const robot = (this.app.selection.robot ?? -1) + by;
    this.app.select({ robot: Math.max(0, Math.min(length - 1, robot)) });
  }

  click({ offsetX, offsetY }) {
    const { app } = this;
    const robot = Math.floor((offsetY + this.box.scrollTop - AXIS_HEIGHT) / this.rowHeight());
    if (robot >= 0 && robot < app.history.scenario.robots.length) app.selection = { robot };
    if (offsetX >= NAME_WIDTH) app.go(this.stepAt(offsetX));
    app.show(true);
  }

  rowHeight() {
    const room = (this.box.clientHeight - AXIS_HEIGHT - 8) / this.app.history.scenario.robots.length;
    return Math.max(LEAST_ROW_HEIGHT, Math.min(ROW_HEIGHT, room));
  }

  x(step) {
    return NAME_WIDTH + (step / Math.max(1, this.app.player.last)) * this.timeWidth();
  }

  timeWidth() {
    return this.width - NAME_WIDTH - SHARE_WIDTH - 6;
  }

  stepAt(x) {
    const part = (x - NAME_WIDTH) / this.timeWidth();
    return Math.max(0, Math.min(this.app.player.last, Math.round(part * this.app.player.last)));
  }

  draw() {
    const { history, map } = this.app;
    this.work();
    this.fit();
    const ctx = this.canvas.getContext("2d");
    ctx.setTransform(this.sharpness, 0, 0, this.sharpness, 0, 0);
    ctx.fillStyle = map.theme.ground;
    ctx.fillRect(0, 0, this.width, this.height);
    const row = this.rowHeight();
    const first = Math.floor(this.box.scrollTop / row);
    const last = Math.min(history.scenario.robots.length, first + Math.ceil(this.height / row) + 1);
    for (let robot = first; robot < last; robot++) {
      this.drawRow(ctx, robot, AXIS_HEIGHT + robot * row - this.box.scrollTop, row);
    }
    this.drawAxis(ctx);
    this.drawNow(ctx);
    this.showLegend();
  }

  // Runs and shares are worked out once for each length of the record.
  work() {
    const { history } = this.app;
    if (this.runs && this.madeFor === history.last) return;
    this.madeFor = history.last;
    this.shares = phaseShares(history, history.last);
    this.runs = history.scenario.robots.map((_, robot) => phaseRuns(history, robot));
  }

  fit() {
    this.width = this.box.clientWidth;
    this.height = this.box.clientHeight;
    this.sharpness = window.devicePixelRatio || 1;
    const [wide, high] = [this.width, this.height].map((side) => Math.round(side * this.sharpness));
    if (this.canvas.width !== wide) this.canvas.width = wide;
    if (this.canvas.height !== high) this.canvas.height = high;
    this.canvas.style.width = `${this.width}px`;
    this.canvas.style.height = `${this.height}px`;
    const rows = this.app.history.scenario.robots.length * this.rowHeight();
    this.canvas.parentElement.style.height = `${Math.max(this.height, AXIS_HEIGHT + rows + 4)}px`;
  }

  drawRow(ctx, robot, top, row) {
    const { history, map, selection } = this.app;
    const { theme } = map;
    const gap = row > 10 ? 2 : 1;
    if (selection.robot === robot) {
      ctx.fillStyle = theme.soft;
      ctx.fillRect(0, top, this.width, row);
    }
    for (const { phase, from, to } of this.runs[robot]) {
      const name = PHASES[phase];
      ctx.fillStyle = theme[PHASE_COLOURS[name]];
      ctx.globalAlpha = name === "lost" ? 0.25 : 1;
      const [left, right] = [this.x(from), this.x(to)];
      ctx.fillRect(left, top + gap / 2, Math.max(0.75, right - left - 0.4), row - gap);
      ctx.globalAlpha = 1;
      if (row >= NAMED_ROWS_FROM && right - left > 34) this.nameRun(ctx, robot, top, row, from, to);
    }
    if (row < NAMED_ROWS_FROM) return;
    ctx.font = `12px ${theme.font}`;
    ctx.textBaseline = "middle";
    ctx.fillStyle = theme.ink;
    ctx.textAlign = "right";
    ctx.fillText(clipped(ctx, robotName(history.scenario, robot), NAME_WIDTH - 14), NAME_WIDTH - 8, top + row / 2);
    ctx.fillStyle = theme.muted;
    ctx.fillText(percent(this.shares[robot][IDLE]), this.width - 10, top + row / 2);
  }

  // The task that the run is about, where it is a wait or a service and there is room.
  nameRun(ctx, robot, top, row, from, to) {
    const { history, map } = this.app;
    const phase = PHASES[phasesIn(history, to)[robot]];
    if (phase !== "serves" && phase !== "waits" && phase !== "walks") return;
    const task = taskOfRun(history, robot, to);
    if (task === NOBODY) return;
    ctx.font = `11px ${map.theme.font}`;
    ctx.textAlign = "left";
    ctx.textBaseline = "middle";
    ctx.fillStyle = map.theme.surface;
    const text = clipped(ctx, taskName(history.scenario, task), this.x(to) - this.x(from) - 8);
    ctx.fillText(text, this.x(from) + 4, top + row / 2 + 0.5);
  }

  drawAxis(ctx) {
    const { history, map, player } = this.app;
    const { theme } = map;
    const { world } = history.scenario;
    ctx.fillStyle = theme.surface;
    ctx.fillRect(0, 0, this.width, AXIS_HEIGHT - 2);
    ctx.fillStyle = theme.muted;
    ctx.font = `11px ${theme.font}`;
    ctx.textBaseline = "middle";
    ctx.textAlign = "center";
    const unit = world.isPlane ? world.stepSeconds : 1;
    const length = player.last * unit;
    const every = SPACINGS.find((step) => (step / length) * this.timeWidth() >= 46) ?? length;
    for (let mark = 0; mark <= length + 1e-9; mark += every) {
      const text = Number(mark.toFixed(2)) + (world.isPlane ? " s" : "");
      ctx.fillText(text, this.x(mark / unit), AXIS_HEIGHT / 2);
    }
    ctx.textAlign = "right";
    ctx.fillText("idle", this.width - 10, AXIS_HEIGHT / 2);
    ctx.fillText("robot", NAME_WIDTH - 20, AXIS_HEIGHT / 2);
  }

  drawNow(ctx) {
    const x = this.x(this.app.player.time);
    ctx.fillStyle = this.app.map.theme.ink;
    ctx.fillRect(x - 0.75, AXIS_HEIGHT - 4, 1.5, this.height);
  }

  // The colours, and the fleet's mean shares; also what those hear who see no bars.
  showLegend() {
    const means = PHASES.map(
      (_, phase) => this.shares.reduce((sum, row) => sum + row[phase], 0) / this.shares.length,
    );
    const items = PHASES.map((name, phase) => {
      const colour = this.app.map.theme[PHASE_COLOURS[name]];
      const dot = element("span", { class: "dot", colour });
      return element("li", {}, dot, `${PHASE_NAMES[name]} ${percent(means[phase])}`);
    });
    byId("phases").replaceChildren(...items);
  }
}

// A text cut so that it fits into so many pixels.
function clipped(ctx, text, width) {
  if (ctx.measureText(text).width <= width) return text;
  let end = text.length;
  while (end > 0 && ctx.measureText(`${text.slice(0, end)}…`).width > width) end--;
  return end > 1 ? `${text.slice(0, end)}…` : "";
}
