// Plots over time: open tasks, idle robots, and the way that the fleet has made.

const PLOTS = [
  { key: "open", title: "Open tasks", colour: "accent", say: sayCount, mark: sayCount },
  { key: "idle", title: "Idle robots", colour: "muted", say: sayCount, mark: sayCount },
  { key: "way", title: "Way of all robots", colour: "good", say: describeWay, mark: shortWay },
];

function sayCount(_, value) {
  return String(value);
}

// A way where the title says what it is: in cells or metres.
function shortWay(world, length) {
  return String(Math.round(length * (world.square ?? 1)));
}

const PLOT_LEFT = 52; // pixels, for numbers
const PLOT_RIGHT = 18;
const PLOT_HEAD = 30;
const PLOT_FOOT = 22;

class Plots {
  constructor(app, canvas) {
    Object.assign(this, { app, canvas });
    new ResizeObserver(() => app.redraw()).observe(canvas.parentElement);
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      this.goTo(event);
    });
    canvas.addEventListener("pointermove", (event) => event.buttons && this.goTo(event));
  }

  goTo({ offsetX }) {
    const part = (offsetX - PLOT_LEFT) / (this.width - PLOT_LEFT - PLOT_RIGHT);
    this.app.go(Math.round(part * this.app.player.last));
  }

  x(step) {
    const part = step / Math.max(1, this.app.player.last);
    return PLOT_LEFT + part * (this.width - PLOT_LEFT - PLOT_RIGHT);
  }

  draw() {
    const { canvas, app } = this;
    const sharpness = window.devicePixelRatio || 1;
    this.width = canvas.parentElement.clientWidth;
    this.height = canvas.parentElement.clientHeight;
    canvas.width = Math.round(this.width * sharpness);
    canvas.height = Math.round(this.height * sharpness);
    const ctx = canvas.getContext("2d");
    ctx.setTransform(sharpness, 0, 0, sharpness, 0, 0);
    ctx.fillStyle = app.map.theme.ground;
    ctx.fillRect(0, 0, this.width, this.height);
    const curves = curvesOf(app.history);
    const high = (this.height - PLOT_FOOT) / PLOTS.length;
    const step = Math.min(app.player.step, app.history.last);
    PLOTS.forEach((plot, number) => this.drawPlot(ctx, plot, curves[plot.key], number * high, high));
    this.drawTimes(ctx);
    ctx.fillStyle = app.map.theme.ink;
    ctx.fillRect(this.x(app.player.time) - 0.75, 4, 1.5, this.height - PLOT_FOOT - 4);
    canvas.setAttribute("aria-label", `${capitalised(describeMoment(app.history.scenario.world, step))}: ${this.said(step)}`);
  }

  // What the plots say of a step.
  said(step) {
    const { history } = this.app;
    const curves = curvesOf(history);
    const { world } = history.scenario;
    return PLOTS.map(({ key, title, say }) => `${title.toLowerCase()} ${say(world, curves[key][step])}`).join(", ");
  }

  drawPlot(ctx, { title, colour, say, mark }, values, top, high) {
    const { map, history, player } = this.app;
    const { theme } = map;
    const [ceiling, floor] = [top + PLOT_HEAD, top + high - 8];
    const most = values.reduce((one, other) => Math.max(one, other), 1);
    const y = (value) => floor - (value / most) * (floor - ceiling);
    const { world } = history.scenario;
    ctx.font = `600 13px ${theme.font}`;
    ctx.textAlign = "left";
    ctx.textBaseline = "middle";
    ctx.fillStyle = theme.ink;
    const now = say(world, values[Math.min(player.step, history.last)]);
    ctx.fillText(`${title}: ${now}`, PLOT_LEFT, top + 16);
    ctx.font = `11px ${theme.font}`;
    ctx.fillStyle = theme.muted;
    ctx.textAlign = "right";
    for (const value of [0, most]) {
      ctx.fillText(mark(world, value), PLOT_LEFT - 7, y(value));
      ctx.fillRect(PLOT_LEFT, Math.round(y(value)), this.width - PLOT_LEFT - PLOT_RIGHT, 0.5);
    }
    ctx.beginPath();
    values.forEach((value, step) => {
      if (step) ctx.lineTo(this.x(step), y(values[step - 1]));
      ctx.lineTo(this.x(step), y(value));
    });
    ctx.strokeStyle = ctx.fillStyle = theme[colour];
    ctx.lineWidth = 1.8;
    ctx.stroke();
    ctx.lineTo(this.x(values.length - 1), floor);
    ctx.lineTo(this.x(0), floor);
    ctx.globalAlpha = 0.13;
    ctx.fill();
    ctx.globalAlpha = 1;
  }

  drawTimes(ctx) {
    const { history, map, player } = this.app;
    const { world } = history.scenario;
    const unit = world.isPlane ? world.stepSeconds : 1;
    const length = player.last * unit;
    const room = this.width - PLOT_LEFT - PLOT_RIGHT;
    const every = SPACINGS.find((spacing) => (spacing / length) * room >= 46) ?? length;
    ctx.fillStyle = map.theme.muted;
    ctx.font = `11px ${map.theme.font}`;
    ctx.textAlign = "center";
    for (let mark = 0; mark <= length + 1e-9 && every > 0; mark += every) {
      const text = Number(mark.toFixed(2)) + (world.isPlane ? " s" : "");
      ctx.fillText(text, this.x(mark / unit), this.height - PLOT_FOOT / 2);
    }
  }
}
