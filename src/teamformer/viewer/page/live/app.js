// The page of a mission under way: the same map and lists, fed by the server, and incidents.

class LiveApp extends App {
  constructor(record, link) {
    super(record, new LivePlayer((message) => this.ask(message)));
    this.link = link;
    this.state = { incidents: [], watchers: 1 };
    this.panel = new MissionPanel(this, byId("mission"));
  }

  // The steps as the server told them are kept, for planes are drawn in other lengths.
  load(record) {
    this.steps = [...record.steps];
    super.load(record);
  }

  lastStep() {
    return this.history.last;
  }

  startText() {
    const isOpen = this.history.end.status === "running";
    return isOpen && this.history.last === 0 && !this.player.isPlaying ? "Start the mission" : "";
  }

  ask(message) {
    if (!this.link.send(message)) notify("The server is not there; nothing was done. Trying again …");
  }

  hear(message) {
    const { kind } = message;
    if (kind === "mission") this.reopen(message.record);
    if (kind === "step") this.take(message);
    if (kind === "incident") this.change(message);
    if ("is_playing" in message) this.takeState(message);
    if (["forecast", "what_if", "offer"].includes(kind)) this.panel.tell(message);
    if (kind === "searching") this.panel.searching(message);
    if (kind === "saved") notify(savedText(message), "good");
    if (kind === "refused") notify(`Not done: ${message.text}.`);
  }

  // The whole mission so far, after the line was down.
  reopen(record) {
    this.load(record);
    this.showAll();
  }

  // A step; one that does not follow the last is of a line that broke, and is told anew.
  take({ at, step, orders = [], plans = [], end }) {
    const { history } = this;
    if (at !== history.last + 1) return;
    history.replay.orders.push(...orders);
    (history.replay.plans ??= []).push(...plans);
    this.steps.push(step);
    history.grow(step, end);
    this.follow();
    if (end) notify(noticeText(history));
  }

  // An incident changes what is known; of the past, only what the latest step led to.
  change({ record, text }) {
    const { selection, options } = this;
    const steps = this.steps.slice(0, -record.steps.length || undefined).concat(record.steps);
    this.load({ ...record, steps });
    Object.assign(this, { selection, options });
    showHeader(this);
    this.follow();
    notify(`Incident in ${text}.`, "good");
  }

  takeState({ is_playing, speed, watchers, incidents, is_fleet = false, warning = "" }) {
    const { player } = this;
    this.state = { watchers, incidents, isFleet: is_fleet, warning };
    Object.assign(player, { isPlaying: is_playing, speed });
    this.panel.show();
    this.show(true);
  }

  follow() {
    this.events = this.history.events.filter(({ kind }) => kind !== "heads");
    byId("scrub").max = String(this.history.last);
    this.player.grow(this.history.last);
    this.timeline.draw();
    this.panel.show();
  }

  // A free place opens the form of a new task there.
  pick(thing, place) {
    const at = this.freePlace(place);
    if (Object.keys(thing).length || !at) return this.select(thing);
    this.panel.askForTask(at);
  }

  freePlace([x, y]) {
    const { world } = this.history.scenario;
    if (world.isPlane) {
      const at = [x, y].map((along) => Number((along * world.square).toFixed(2)));
      return x >= 0 && y >= 0 && x <= world.width && y <= world.height ? at : null;
    }
    const at = [Math.round(x), Math.round(y)];
    return isFreeCell(world, ...at) ? at : null;
  }

  actionsFor(robot) {
    if (this.state.isFleet) return []; // its robots are lost and back by themselves
    const { last, scenario, replay } = this.history;
    const name = robotName(scenario, robot);
    const isGone = isLost(this.history, robot, last);
    const { lost = [], back = [] } = replay.scenario.robots[robot]; // steps, lists if several
    if ([isGone ? back : lost].flat().includes(last + 1)) {
      const what = isGone ? "is there again" : "counts for nothing";
      return [element("p", { class: "muted" }, `${name} ${what} from the next step on.`)];
    }
    const [words, incident] = isGone ? [`Bring ${name} back`, { back: name }] : [`Lose ${name}`, { lost: name }];
    const weighing = isGone ? "What would that gain?" : "What would that cost?";
    return [
      element(
        "div",
        { class: "acts" },
        act(words, () => this.ask({ do: "happen", ...incident }), `${isGone ? "back" : "lose"} ${robot}`),
        act(weighing, () => this.panel.weigh(incident), `weigh ${robot}`),
      ),
    ];
  }

  // The address names the step only while one looks back.
  address() {
    const parts = new URLSearchParams(super.address());
    if (this.player.isFollowing) parts.delete("step");
    return parts.toString();
  }

  open(record, isBeside) {
    if (isBeside) super.open(record, true);
    else notify("This page shows a live mission; put the record beside it, or open it with `view`.");
  }
}

function savedText({ paths, note }) {
  return `Saved: ${paths.join(", ")}${note ? `; ${note}` : ""}`;
}

function act(text, on, key) {
  return element("button", { type: "button", on, "data-key": key }, text);
}
