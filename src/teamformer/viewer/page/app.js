// The page as a whole: one trial, one clock, one selection.

const LINES_UP_TO = 30; // teams; with more, the lines to assignments are off at first

class App {
  constructor(replay) {
    this.history = frames(replay);
    const { scenario } = this.history;
    this.events = this.history.events.filter(({ kind }) => kind !== "heads");
    this.colours = capabilityColours(scenario.capabilities.length);
    this.labels = shortLabels(scenario.capabilities);
    this.selection = {}; // {robot}, {task}, {cap} or nothing
    const isSmall = scenario.robots.length <= LINES_UP_TO;
    this.options = {
      lines: isSmall,
      trails: false,
      order: false,
      names: scenario.tasks.length <= 2 * LINES_UP_TO,
    };
    this.sceneAt = rememberLast(STATES_KEPT, (step) => sceneAt(this.history, step));
    this.player = new Player(this.history.last, (isNewStep) => this.show(isNewStep));
    this.map = new TrialMap(this, byId("map"));
    this.lists = new Lists(this);
    this.timeline = new Timeline(this, byId("marks"));
  }

  start() {
    showHeader(this);
    connectControls(this);
    this.readAddress();
    addEventListener("hashchange", () => this.readAddress());
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.show(true));
    this.show(true);
  }

  scene() {
    return this.sceneAt(this.player.step);
  }

  selectedTeam() {
    return this.selection.robot === undefined
      ? null
      : teamOfRobot(this.scene(), this.selection.robot);
  }

  select(selection) {
    this.selection = selection;
    this.show(true);
  }

  toggle(option) {
    this.options[option] = !this.options[option];
    this.show(true);
  }

  go(step) {
    this.player.pause();
    this.player.go(step);
  }

  goToEvent(event) {
    if (event.task !== undefined) this.selection = { task: event.task };
    else if (event.kind === "join") this.selection = { robot: event.joiner };
    else if (event.kind === "split") this.selection = { robot: event.stay[0] };
    else if (event.kind === "lost") this.selection = { robot: event.robot };
    this.go(event.step);
    this.show(true);
  }

  // The nearest earlier (-1) or later (+1) step in which something happens.
  goToNextEvent(direction) {
    const { step } = this.player;
    const steps = this.events.map((event) => event.step);
    const next = direction > 0 ? steps.find((at) => at > step) : steps.findLast((at) => at < step);
    this.go(next ?? (direction > 0 ? this.history.last : 0));
  }

  // `#step=12&task=crate-7`, or `&robot=r1`, or `&capability=lift`.
  readAddress() {
    const wanted = new URLSearchParams(location.hash.slice(1));
    const { robots, tasks, capabilities } = this.history.scenario;
    const task = tasks.findIndex(({ name }) => name === wanted.get("task"));
    const robot = robots.findIndex(({ name }) => name === wanted.get("robot"));
    const cap = capabilities.indexOf(wanted.get("capability"));
    if (task >= 0) this.select({ task });
    else if (robot >= 0) this.select({ robot });
    else if (cap >= 0) this.select({ cap });
    if (wanted.has("step")) this.go(Math.round(Number(wanted.get("step"))) || 0);
  }

  redraw() {
    if (this.isDrawing) return;
    this.isDrawing = true;
    requestAnimationFrame(() => {
      this.isDrawing = false;
      this.map.draw();
    });
  }

  // Bring the page to the moment and the selection that hold now.
  show(isNewStep) {
    this.redraw();
    if (!isNewStep || this.isShowing) return;
    this.isShowing = true;
    requestAnimationFrame(() => {
      this.isShowing = false;
      this.showStep();
    });
  }

  showStep() {
    const { player } = this;
    showFigures(this);
    showDetails(this);
    this.lists.follow();
    byId("scrub").value = String(player.step);
    byId("scrub").setAttribute("aria-valuetext", `step ${player.step} of ${this.history.last}`);
    byId("speed").value = String(player.speed);
    byId("play").classList.toggle("on", player.isPlaying);
    byId("play").setAttribute("aria-label", player.isPlaying ? "Pause" : "Play");
    for (const [name, isOn] of Object.entries(this.options)) {
      byId(name).setAttribute("aria-pressed", String(isOn));
    }
    const title = `Map of ${this.history.scenario.name} at step ${player.step}`;
    this.map.canvas.setAttribute("aria-label", title);
    if (!player.isPlaying) this.say();
  }

  // What happens in this step, for those who listen.
  say() {
    const { step } = this.player;
    const texts = this.events.filter((event) => event.step === step).slice(0, 8);
    const said = texts.map((event) => describeEvent(this.history, event)).join("; ");
    byId("said").textContent = `Step ${step} of ${this.history.last}. ${said}`;
  }
}
