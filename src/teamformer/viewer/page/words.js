// Everything that the page says about robots, teams and tasks, as plain text.

const MANY = 3; // names written out

function robotName(scenario, robot) {
  return scenario.robots[robot].name;
}

function taskName(scenario, task) {
  return scenario.tasks[task].name;
}

// A lone robot goes by its own name, a team by that of its lowest robot.
function teamName(scenario, slot, size) {
  return size === 1 ? robotName(scenario, slot) : `team ${robotName(scenario, slot)}`;
}

function nameOfTeam(scenario, team) {
  return teamName(scenario, team.slot, team.robots.length);
}

// A few names are written out; of many, the first stands for all.
function listRobots(scenario, robots) {
  const shown = robots.length <= MANY ? robots : robots.slice(0, 1);
  const names = shown.map((robot) => robotName(scenario, robot)).join(", ");
  return shown.length < robots.length ? `${names} + ${robots.length - 1} more` : names;
}

function describeCounts(scenario, counts, shown = Infinity) {
  const pairs = [...counts];
  const texts = pairs.slice(0, shown).map(([cap, count]) => {
    const name = scenario.capabilities[cap];
    return count === 1 ? name : `${count} x ${name}`;
  });
  if (pairs.length > shown) texts.push(`${pairs.length - shown} more`);
  return texts.join(", ");
}

function plural(count, word) {
  return `${count} ${word}${count === 1 ? "" : "s"}`;
}

function capitalised(text) {
  return text.charAt(0).toUpperCase() + text.slice(1);
}

// How far a team has to walk to a task.
function distanceTo(scenario, team, task) {
  return walkingDistance(scenario.world, [team.x, team.y], scenario.tasks[task].at);
}

// What a team is about, in one word: serves, done, waits, walks or idle.
function activityOf(scenario, team) {
  if (team.service) return "serves";
  if (team.justDone !== NOBODY) return "done";
  if (team.assigned === NOBODY) return "idle";
  const { at } = scenario.tasks[team.assigned];
  return isSamePlace(scenario.world, [team.x, team.y], at) ? "waits" : "walks";
}

function describeDoing(scenario, team, step) {
  const name = team.goal === NOBODY ? "" : taskName(scenario, team.goal);
  const lack = describeCounts(scenario, team.missing, MANY);
  switch (activityOf(scenario, team)) {
    case "serves": {
      const { duration } = scenario.tasks[team.goal];
      return `does ${name}, ${step - team.service.from} of ${plural(duration, "step")} made`;
    }
    case "done":
      return `has just done ${name}`;
    case "idle":
      return "has no assignment";
    case "waits":
      return team.isMet ? `is at ${name} with all it needs` : `waits at ${name} for ${lack}`;
    default: {
      const away = distanceTo(scenario, team, team.assigned);
      const way = `${describeWay(scenario.world, away)} to go`;
      return team.isMet
        ? `walks to ${name} with all it needs, ${way}`
        : `walks to ${name}, ${way}; lacks ${lack}`;
    }
  }
}

function describeStanding(history, task, scene) {
  const { scenario } = history;
  const { step } = scene;
  const { appears, duration } = scenario.tasks[task];
  switch (standingOf(history, task, step)) {
    case "hidden":
      return `appears after step ${appears}`;
    case "done":
      return `done in step ${history.doneAt[task]}`;
    case "served": {
      const made = step - serviceOf(history, task, step).from;
      return `under way, ${made} of ${plural(duration, "step")} made`;
    }
    case "blocked":
      return "can never be done";
    default: {
      const assigned = scene.assignedTo.get(task)?.length ?? 0;
      return assigned ? `open, ${plural(assigned, "team")} assigned` : "open, nobody assigned";
    }
  }
}

// Written once for each event.
function describeEvent(history, event) {
  event.text ??= eventText(history, event);
  return event.text;
}

function eventText(history, event) {
  const { scenario } = history;
  const task = event.task === undefined ? "" : taskName(scenario, event.task);
  const team = event.slot === undefined ? "" : teamName(scenario, event.slot, event.size);
  switch (event.kind) {
    case "join":
      return describeJoin(scenario, event);
    case "split":
      return describeSplit(scenario, event);
    case "lost":
      return `${robotName(scenario, event.robot)} is lost`;
    case "appears":
      return `${task} appears`;
    case "heads":
      return `${team} heads for ${task}`;
    case "begins":
      return `${team} begins ${task}`;
    case "done":
      return `${task} done by ${team}`;
    default:
      return describeEnd(history);
  }
}

function describeJoin(scenario, { joiner, partner, joiners, partners }) {
  const names = [teamName(scenario, joiner, joiners), teamName(scenario, partner, partners)];
  const text = names.join(" joins ");
  const total = joiners + partners;
  return total > 2 ? `${text}, now ${total}` : text;
}

function describeSplit(scenario, { slot, stay, leave }) {
  const parts = `${listRobots(scenario, stay)} | ${listRobots(scenario, leave)}`;
  return `${teamName(scenario, slot, stay.length + leave.length)} splits: ${parts}`;
}

function describeEnd({ end }) {
  const blocked = end.blocked_tasks.join(", ");
  return {
    completed: `completed, makespan ${end.makespan}`,
    "step limit": "stopped at the step limit",
    infeasible: `stopped, for ${blocked} can never be done`,
    interrupted: "interrupted",
  }[end.status];
}
