// A record that is shown, with all that its map and its chart ask for: of the page, or beside it.

export class Shown {
  /** @type {Trial} */ trial;
  /** @type {TrialHistory} */ history;
  /** @type {Colour[]} */ colours;
  /** @type {string[]} */ labels;
  /** @type {(step: number) => Scene} */ sceneAt;
  /** @type {RecordTree} */ record;

  // All shown records have the clock and the options of the page.
  constructor(/** @type {Player} */ player, /** @type {Options} */ options) {
    this.player = player;
    this.options = options;
  }

  put(/** @type {Trial} */ trial) {
    Object.assign(this, trial, { trial });
  }

  scene() {
    return this.sceneAt(Math.min(this.player.step, this.history.last));
  }
}
