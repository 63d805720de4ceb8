// The strip over the slider: tasks done over time, where teams form, the lower bound.

const THUMB = 16; // pixels; the slider's ends are half of it inside the strip

class Timeline {
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
    const part = (offsetX - THUMB / 2) / (this.canvas.clientWidth - THUMB);
    this.app.go(Math.round(part * this.app.player.last));
  }

  x(step) {
    const { last } = this.app.player;
    return THUMB / 2 + (last ? step / last : 0) * (this.canvas.clientWidth - THUMB);
  }

  draw() {
    const { canvas } = this;
    const sharpness = window.devicePixelRatio || 1;
    canvas.width = Math.round(canvas.clientWidth * sharpness);
    canvas.height = Math.round(canvas.clientHeight * sharpness);
    const ctx = canvas.getContext("2d");
    ctx.scale(sharpness, sharpness);
    this.drawDone(ctx, canvas.clientHeight - 9);
    this.drawMarks(ctx, canvas.clientHeight - 8);
    this.drawBound(ctx, canvas.clientHeight - 9);
  }

  drawDone(ctx, height) {
    const { history, map } = this.app;
    const steps = history.doneAt.filter((at) => at < Infinity).sort((one, other) => one - other);
    const top = (count) => height - (count / history.doneAt.length) * (height - 2);
    ctx.beginPath();
    ctx.moveTo(this.x(0), height);
    steps.forEach((step, before) => {
      ctx.lineTo(this.x(step), top(before));
      ctx.lineTo(this.x(step), top(before + 1));
    });
    ctx.lineTo(this.x(history.last), top(steps.length));
    ctx.strokeStyle = ctx.fillStyle = map.theme.accent;
    ctx.lineWidth = 1.5;
    ctx.stroke();
    ctx.lineTo(this.x(history.last), height);
    ctx.globalAlpha = 0.16;
    ctx.fill();
    ctx.globalAlpha = 1;
  }

  // Joins, splits, losses and returns, one tick each; those in the same pixel cover each other.
  drawMarks(ctx, top) {
    const drawn = new Set();
    for (const event of this.app.events) {
      if (!["join", "split", "lost", "back"].includes(event.kind)) continue;
      const x = Math.round(this.x(event.step));
      if (drawn.has(`${x} ${event.kind}`)) continue;
      drawn.add(`${x} ${event.kind}`);
      ctx.fillStyle = eventColour(this.app, event);
      ctx.fillRect(x - 0.75, top, 1.5, event.kind === "split" ? 4 : 7);
    }
  }

  drawBound(ctx, height) {
    const { history, map } = this.app;
    if (history.lowerBound === null || history.lowerBound > history.last) return;
    const x = this.x(history.lowerBound);
    ctx.strokeStyle = ctx.fillStyle = map.theme.muted;
    ctx.setLineDash([3, 2]);
    ctx.beginPath();
    ctx.moveTo(x, 0);
    ctx.lineTo(x, height);
    ctx.stroke();
    ctx.setLineDash([]);
    ctx.font = `10px ${map.theme.font}`;
    ctx.textBaseline = "top";
    ctx.textAlign = x > 60 ? "right" : "left";
    ctx.lineWidth = 3;
    ctx.strokeStyle = map.theme.surface;
    ctx.strokeText("bound", x + (x > 60 ? -4 : 4), 1);
    ctx.fillText("bound", x + (x > 60 ? -4 : 4), 1);
  }
}
