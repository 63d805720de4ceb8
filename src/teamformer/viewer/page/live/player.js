// The clock of a live mission: it follows the latest step unless one looks back.

import { Player } from "../player.js";
import { TICKS } from "../record/ticks.js";

const MINUTE = 60; // seconds that a mission takes about at a speed in the middle
const BEAT = 0.2; // seconds between two moments that the server tells of in continuous time

export class LivePlayer extends Player {
  constructor(/** @type {(message: Message) => void} */ say) {
    super(0);
    this.say = say; // what the server is to do
    this.isFollowing = true;
  }

  reset(last, tick = null) {
    const { isPlaying, speed } = this;
    super.reset(last, tick);
    if (tick !== null) this.speeds = roundRates(tick);
    this.time = last;
    Object.assign(this, { isPlaying, speed, isFollowing: true });
  }

  // How many steps a second the server makes, or how many units of time pass.
  hearSpeed(speed) {
    this.speed = this.tick === null ? speed : speed / this.tick;
  }

  // Another length of the same mission, or another moment of the server's clock.
  grow(last) {
    this.last = last;
    if (this.isFollowing) this.chase();
    else this.changed(true);
  }

  // Walk on to the latest step, faster the farther behind.
  chase() {
    if (this.isChasing) return;
    this.isChasing = true;
    let before = performance.now();
    const tick = (now) => {
      this.isChasing = this.isFollowing;
      if (!this.isChasing) return;
      const behind = this.last - this.time;
      const pace = this.speed * Math.max(1, this.tick === null ? behind : behind / (BEAT * this.speed));
      const was = this.step;
      const walked = (Math.max(0, now - before) / 1000) * pace; // a frame may be dated before us
      this.time = Math.min(this.last, this.time + walked);
      before = now;
      this.changed(this.step !== was);
      this.isChasing = this.isFollowing && this.time < this.last;
      if (this.isChasing) requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }

  // Looking back leaves the mission alone.
  pause() {}

  go(time) {
    super.go(time);
    this.isFollowing = this.time >= this.last;
  }

  play() {
    this.say({ do: "play" });
  }

  toggle() {
    this.say({ do: this.isPlaying ? "pause" : "play" });
  }

  stepBy(steps) {
    if (steps > 0 && this.isFollowing) this.say({ do: "step" });
    else this.go(this.step + steps);
  }

  goAt(speed) {
    this.say({ do: "speed", speed: this.tick === null ? speed : Number((speed * this.tick).toPrecision(6)) });
  }
}

// In ticks a second, round numbers of units a second about that by which a mission takes a minute.
function roundRates(/** @type {number} */ tick) {
  const power = 10 ** Math.floor(Math.log10((TICKS * tick) / MINUTE));
  return [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50].map((times) => Number((times * power).toPrecision(3)) / tick);
}
