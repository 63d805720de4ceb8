// A second record beside the first one: its own map, the same clock.

class Companion {
  constructor(app) {
    this.app = app;
    this.box = byId("beside");
    this.history = null;
    this.selection = {};
    byId("beside-close").addEventListener("click", () => this.leave());
  }

  load(record) {
    Object.assign(this, readTrial(record));
    this.box.hidden = false;
    this.map ??= new TrialMap(this, byId("map-beside"));
    this.map.look(this.history.scenario.world);
    connectView(this.map);
  }

  // Close it for good, with the clock of the first record alone.
  leave() {
    this.close();
    this.app.player.shorten(this.app.lastStep());
    byId("scrub").max = String(this.app.player.last);
    this.app.showAll();
  }

  close() {
    this.history = null;
    this.box.hidden = true;
  }

  lastStep() {
    return this.history?.last ?? 0;
  }

  get player() {
    return this.app.player;
  }

  get options() {
    return this.app.options;
  }

  scene() {
    return this.sceneAt(Math.min(this.player.step, this.history.last));
  }

  selectedTeam() {
    return null;
  }

  redraw() {
    this.app.redraw();
  }

  draw() {
    if (!this.history) return;
    const { history } = this;
    const { step } = this.player;
    byId("beside-name").textContent = `${history.scenario.name}, ${history.replay.method}`;
    byId("beside-state").textContent = describeProgress(history, step);
    this.map.draw();
  }
}
