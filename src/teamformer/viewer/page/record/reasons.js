// Why a team does what it does, worked out from the record: plans, orders, and what made them anew.

// The reason for what a team does after a step, as a sentence without its end.
function reasonFor(history, team, step) {
  if (team.justDone !== NOBODY) return "";
  if (team.assigned === NOBODY && !team.service) return reasonForRest(history, team, step);
  if (team.service) return "it brings all that the task needs, and stays until that is done";
  return [reasonForTask(history, team, step), planText(history, step)].filter(Boolean).join("; ");
}

function reasonForTask(history, team, step) {
  const task = team.assigned;
  const { steps } = history.replay;
  const named = steps.slice(Math.max(0, step - 1), step).some((it) => it.named?.includes(team.slot));
  if (named) return "its policy named the task itself";
  const crew = crewOf(history, team.slot, step);
  if (crew) {
    const rank = crew.left.indexOf(task);
    if (rank >= 0) return `${ordinal(rank)} of ${plural(crew.left.length, "task")} left to crew ${crew.number}`;
    return `on the list of another crew than its own, number ${crew.number}`;
  }
  const rank = orderAt(history, step).indexOf(task);
  if (rank < 0) return "";
  if (rank === 0) return "first in the order that everybody shares";
  return `${ordinal(rank)} in the order that everybody shares, the first it was sent to`;
}

// Who has no assignment: whether anything is left that its robots could help with.
function reasonForRest({ scenario, doneAt }, team, step) {
  const open = scenario.tasks.filter(({ appears }, task) => appears <= step && doneAt[task] > step);
  if (!open.length) return "no task is open";
  const useful = open.filter(({ needs }) => needs.some(([cap]) => team.counts.has(cap)));
  if (!useful.length) return "no open task needs what it brings";
  const names = useful.slice(0, MANY).map(({ name }) => name);
  const more = useful.length > MANY ? ` and ${useful.length - MANY} more` : "";
  return `others are to do ${names.join(", ")}${more}`;
}

// When the plan or order that holds was made, and what made it anew.
function planText(history, step) {
  const made = latestPlan(history, step);
  if (!made) return "";
  const causes = causesIn(history, made);
  const when = describeMoment(history.scenario.world, made);
  return `planned anew ${history.scenario.world.isPlane ? "at" : "after"} ${when}${causes ? `: ${causes}` : ""}`;
}

function latestPlan({ replay }, step) {
  const plans = [...(replay.orders ?? []), ...(replay.crews ?? [])].map(([made]) => made);
  return Math.max(0, ...plans.filter((made) => made <= step));
}

// What happened in the step after which a plan was made.
function causesIn(history, made) {
  const kinds = ["appears", "lost"];
  const events = history.events.filter(({ step, kind }) => step === made && kinds.includes(kind));
  return events.map((event) => describeEvent(history, event)).join(", ");
}

function ordinal(rank) {
  return ["first", "second", "third"][rank] ?? `number ${rank + 1}`;
}
