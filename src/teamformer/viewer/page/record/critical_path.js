// The critical path: the chain of ways, waits, services and forming that the end hangs on.
// @ts-nocheck
// `critical_path/of_record.py` has the same rules; a test holds the two against one another.

import { AT_WORK, PHASES, PHASE_NAMES, phasesIn, pursuitsIn } from "./phases.js";
import { NOBODY, robotsOfTeam } from "./state.js";

// Stretches [{from, to, doing, robot, task}], the first one first; none unless all tasks were done,
// and it is known by whom.
// Before a task is known or may begin ("unknown", "closed") there is no robot.
export function criticalPath(history) {
  const { doneAt, doneBy } = history;
  if (!history.end?.makespan || doneAt.some((at, task) => at < Infinity && doneBy[task] === NOBODY)) return [];
  return inOrder(new PathTracing(history).stretches(history.end.makespan));
}

// Stretches found from the end to the start in the order of time; neighbours that are alike are one.
function inOrder(found) {
  const path = [];
  for (const stretch of found) {
    if (stretch.from === stretch.to) continue;
    const last = path.at(-1);
    const isSame = last && ["doing", "robot", "task"].every((key) => last[key] === stretch[key]);
    if (isSame && last.from === stretch.to) last.from = stretch.from;
    else path.push({ ...stretch });
  }
  return path.reverse();
}

// Goes back through a record: `now` steps are made, and it hangs on `robots` being ready.
class PathTracing {
  constructor(history) {
    this.history = history;
    this.robots = [];
    this.task = NOBODY; // that they were ready for
    this.together = []; // what they did as a team, not told yet: [stretch, robots]
    this.passedOn = -1; // where the path last went from an idle robot to who did a task
    this.found = [];
  }

  stretches(makespan) {
    const { doneAt } = this.history;
    const last = doneAt.indexOf(makespan);
    if (last < 0) return []; // it ended with a task that was called off
    this.goBefore(last, makespan);
    while (this.now > 0) {
      const { robot, step } = this.lastBusy();
      if (step < this.now) this.goBeforeWait(robot, step);
      else this.goBeforeStep(robot);
    }
    this.tellOf(this.robots[0]);
    return this.found;
  }

  // What a team did together, as done by the one of it that was ready last.
  tellOf(robot) {
    for (const [stretch, robots] of this.together) {
      this.found.push({ ...stretch, robot: robots.includes(robot) ? robot : robots[0] });
    }
    this.together = [];
  }

  // A service that was broken off came to nothing: whoever was there waited.
  doing(robot, step) {
    const doing = PHASE_NAMES[PHASES[phasesIn(this.history, step)[robot]]];
    if (!AT_WORK.includes(doing)) return doing;
    return this.taskServed(robot, step) === NOBODY ? "waiting" : "serving";
  }

  pursued(robot, step) {
    return pursuitsIn(this.history, step)[robot];
  }

  // Which robot was the last to do something, and in which step: 0 if none did.
  lastBusy() {
    for (let step = this.now; step > 0; step--) {
      const robot = this.robots.find((one) => !["waiting", "idle"].includes(this.doing(one, step)));
      if (robot !== undefined) return { robot, step };
    }
    return { robot: this.robots[0], step: 0 };
  }

  goBeforeStep(robot) {
    const { now, history } = this;
    const doing = this.doing(robot, now);
    if (doing === "serving") {
      this.tellOf(robot);
      this.goBefore(this.taskServed(robot, now), now);
      return;
    }
    const task = this.pursued(robot, now);
    const stretch = { from: now - 1, to: now, doing, robot, task };
    this.robots = [robot];
    this.now--;
    if (task !== NOBODY) this.task = task;
    if (doing === "forming") {
      const state = history.at(now);
      this.robots = ledBy(this.robots, robotsOfTeam(state, state.team[robot]));
      this.together.push([stretch, this.robots]);
    } else {
      this.tellOf(robot);
      this.found.push(stretch);
    }
  }

  // The task that a robot helped to do in a step, by the service that ended with it done.
  taskServed(robot, step) {
    const { doers, doneAt } = this.history;
    return doers.findIndex(
      (robots, task) =>
        robots.includes(robot) && this.beginning(task).from < step && step <= doneAt[task],
    );
  }

  // When the service that a task was done by began, and with which robots.
  beginning(task) {
    const { services, doneAt, doers } = this.history;
    const service = services[task].findLast(({ to }) => to === doneAt[task]);
    return service ?? { from: doneAt[task], robots: doers[task] };
  }

  // Back to when those who began a service were ready for it.
  goBefore(task, until) {
    const { from, robots } = this.beginning(task);
    this.robots = ledBy(this.robots, robots);
    this.task = task;
    this.together.push([{ from, to: until, doing: "serving", task }, this.robots]);
    this.now = from;
  }

  // Back to before the time in which nobody who was needed did anything.
  goBeforeWait(robot, busy) {
    const { mission, doneAt, doers } = this.history;
    const { appears, opens } = mission.tasks[this.task] ?? { appears: -1, opens: -1 };
    const opened = Math.max(appears, opens);
    this.tellOf(robot);
    if (opened > 0 && busy <= opened && opened <= this.now) {
      this.stand(robot, opened);
      this.goBeforeOpening();
      return;
    }
    if (this.doing(robot, this.now) === "idle" && this.now !== this.passedOn) {
      this.passedOn = this.now;
      const isDone = (it, task) => it === this.now && !doers[task].includes(robot);
      const task = doneAt.findIndex(isDone); // what others did gave it its next task
      if (task !== NOBODY) {
        this.robots = doers[task];
        this.task = task;
        return;
      }
    }
    this.stand(robot, busy);
  }

  // Back to when a robot began to wait, for a task or for a task to be given.
  stand(robot, since) {
    for (; this.now > since; this.now--) {
      const [doing, task] = [this.doing(robot, this.now), this.pursued(robot, this.now)];
      this.found.push({ from: this.now - 1, to: this.now, doing, robot, task });
    }
  }

  // Back from when a task opened to what it waited for.
  goBeforeOpening() {
    const { mission, doneAt } = this.history;
    const before = mission.tasks[this.task].after.find((task) => doneAt[task] === this.now);
    if (before !== undefined) {
      this.goBefore(before, this.now);
      return;
    }
    const isClosed = mission.tasks[this.task].appears < this.now;
    const doing = isClosed ? "closed" : "unknown";
    this.found.push({ from: 0, to: this.now, doing, robot: NOBODY, task: this.task });
    this.now = 0;
  }
}

// Robots in order, but first the one that the path followed before, if it is there.
function ledBy([leader], robots) {
  const others = robots.filter((robot) => robot !== leader).sort((one, other) => one - other);
  return others.length < robots.length ? [leader, ...others] : others;
}
