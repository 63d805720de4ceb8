// Tasks done over time, a line for each record, and where each one's makespan is.

const CURVES_HEIGHT = 120; // pixels
const CURVES_LEFT = 30; // for the number of tasks
const CURVES_BELOW = 16; // for the time

class Curves {
  constructor(app, canvas) {
    this.app = app;
    this.canvas = canvas;
    new ResizeObserver(() => app.history && this.draw()).observe(canvas);
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      this.scrubTo(event);
    });
    canvas.addEventListener("pointermove", (event) => event.buttons && this.scrubTo(event));
  }

  scrubTo({ offsetX }) {
    const part = (offsetX - CURVES_LEFT) / this.room();
    this.app.go(Math.round(part * this.app.player.last));
  }

  room() {
    return this.canvas.clientWidth - CURVES_LEFT - 10;
  }

  x(step) {
    return CURVES_LEFT + (step / Math.max(1, this.app.player.last)) * this.room();
  }

  y(part) {
    return 6 + (1 - part) * (CURVES_HEIGHT - CURVES_BELOW - 6);
  }

  draw() {
    const { app, canvas } = this;
    if (!canvas.clientWidth) return;
    const sharpness = window.devicePixelRatio || 1;
    canvas.width = Math.round(canvas.clientWidth * sharpness);
    canvas.height = Math.round(CURVES_HEIGHT * sharpness);
    const ctx = canvas.getContext("2d");
    ctx.scale(sharpness, sharpness);
    this.drawAxes(ctx);
    for (const trial of app.trials) this.drawLine(ctx, trial);
    ctx.fillStyle = app.map.theme.ink;
    ctx.fillRect(this.x(app.player.time) - 0.75, 2, 1.5, CURVES_HEIGHT - CURVES_BELOW);
  }

  drawAxes(ctx) {
    const { map, player, history } = this.app;
    const { theme } = map;
    const { world } = history.scenario;
    ctx.strokeStyle = theme.line;
    ctx.strokeRect(this.x(0) - 0.5, this.y(1) - 0.5, this.room() + 1, this.y(0) - this.y(1) + 1);
    ctx.fillStyle = theme.muted;
    ctx.font = `10px ${theme.font}`;
    ctx.textAlign = "right";
    ctx.textBaseline = "middle";
    ctx.fillText("100%", CURVES_LEFT - 4, this.y(1) + 2);
    ctx.fillText("0", CURVES_LEFT - 4, this.y(0) - 2);
    ctx.textBaseline = "bottom";
    ctx.fillText(describeAmount(world, player.last), this.x(player.last), CURVES_HEIGHT);
    ctx.textAlign = "left";
    ctx.fillText(world.isPlane ? "tasks done over seconds" : "tasks done over steps", CURVES_LEFT, CURVES_HEIGHT);
    const bound = history.lowerBound;
    if (bound === null || bound > player.last) return;
    ctx.setLineDash([3, 2]);
    ctx.strokeStyle = theme.muted;
    ctx.beginPath();
    ctx.moveTo(this.x(bound), this.y(1));
    ctx.lineTo(this.x(bound), this.y(0));
    ctx.stroke();
    ctx.setLineDash([]);
    ctx.textAlign = "right";
    ctx.textBaseline = "top";
    if (this.x(bound) > CURVES_LEFT + 40) ctx.fillText("bound", this.x(bound) - 3, this.y(1) + 2);
  }

  // The line of what was done, and a dot at the makespan.
  drawLine(ctx, trial) {
    const { history } = trial;
    const count = history.doneAt.length;
    ctx.strokeStyle = ctx.fillStyle = recordColour(this.app, trial);
    ctx.lineWidth = trial === this.app.trial ? 2.5 : 1.5;
    ctx.beginPath();
    ctx.moveTo(this.x(0), this.y(0));
    doneOverTime(history).forEach((step, before) => {
      ctx.lineTo(this.x(step), this.y(before / count));
      ctx.lineTo(this.x(step), this.y((before + 1) / count));
    });
    ctx.lineTo(this.x(history.last), this.y(countDone(history, history.last) / count));
    ctx.stroke();
    ctx.lineWidth = 1;
    if (history.end.makespan === null) return;
    ctx.beginPath();
    ctx.arc(this.x(history.end.makespan), this.y(1), 3.5, 0, 2 * Math.PI);
    ctx.fill();
  }
}

// The steps in which tasks were done, in order.
function doneOverTime({ doneAt }) {
  return doneAt.filter((at) => at < Infinity).sort((one, other) => one - other);
}
