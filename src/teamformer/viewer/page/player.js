// The clock of the page: which moment is shown, and how fast it moves on.

import { roundUp } from "./record/ticks.js";

export const SPEEDS = [0.5, 1, 2, 4, 8, 16, 32, 64]; // steps a second
const SECONDS_AT_START = 25; // about how long a record takes at the speed it opens with

export class Player {
  last = 0;
  time = 0; // in steps
  speed = 2; // steps a second
  speeds = SPEEDS;
  /** @type {number | null} */ tick = null; // how long a step is in continuous time
  isFollowing = false; // the latest step of a mission that is under way

  constructor(last) {
    // Set from outside, it is called whenever another moment is to be shown.
    /** @type {(isNewStep: boolean) => void} */ this.changed = () => {};
    this.isPlaying = false;
    this.isStill = matchMedia("(prefers-reduced-motion: reduce)");
    this.reset(last);
  }

  // Back to the start of what takes so many steps; `tick` is how long each is in continuous time.
  reset(last, /** @type {number | null} */ tick = null) {
    this.isPlaying = false;
    this.last = last;
    this.time = 0;
    this.tick = tick;
    this.speeds = tick === null ? SPEEDS : ratesFor(last, tick);
    this.speed = this.speeds.find((speed) => speed >= 2 && last / speed <= SECONDS_AT_START) ?? this.speeds[this.speeds.length - 1];
  }

  shorten(last) {
    this.last = last;
    this.time = Math.min(this.time, last);
  }

  get step() {
    return Math.floor(this.time);
  }

  // How far the way to the next step is made, 0..1.
  get part() {
    return this.isStill.matches ? 0 : this.time - this.step;
  }

  go(time) {
    const before = this.step;
    this.time = Math.max(0, Math.min(this.last, time));
    this.changed(this.step !== before);
  }

  pause() {
    if (!this.isPlaying) return;
    this.isPlaying = false;
    this.go(Math.round(this.time));
    this.changed(true);
  }

  play() {
    if (this.last === 0) return;
    if (this.time >= this.last) this.time = 0;
    this.isPlaying = true;
    this.changed(true);
    let before = performance.now();
    const tick = (now) => {
      if (!this.isPlaying) return;
      this.go(this.time + ((now - before) / 1000) * this.speed);
      before = now;
      if (this.time >= this.last) this.pause();
      else requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }

  toggle() {
    if (this.isPlaying) this.pause();
    else this.play();
  }

  stepBy(steps) {
    this.pause();
    this.go(this.step + steps);
  }

  // The next speed up or down of those offered.
  faster(by) {
    const { speeds } = this;
    const nearest = speeds.findLastIndex((speed) => speed <= this.speed);
    this.goAt(speeds[Math.max(0, Math.min(speeds.length - 1, nearest + by))]);
  }

  goAt(speed) {
    this.speed = speed;
    this.changed(true);
  }
}

// In continuous time: ticks a second, at which round numbers of units pass in one.
function ratesFor(last, tick) {
  const middle = roundUp((last * tick) / SECONDS_AT_START);
  const rates = [0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10].map((times) => roundUp(middle * times));
  return [...new Set(rates)].map((rate) => rate / tick);
}
