// Why a team does what it does, worked out from the record: plans, orders, and what made them anew.
// @ts-nocheck

import { NEWS, needsAt } from "./history.js";
import { describeMoment } from "./lengths.js";
import { isOver, orderAt } from "./scene.js";
import { NOBODY } from "./state.js";
import { MANY, describeEvent, listRobots, taskName } from "./words.js";

// The reason for what a team does after a step, as a sentence without its end.
export function reasonFor(history, team, step) {
  if (team.justDone !== NOBODY || team.activity === "leaves") return "";
  if (team.activity === "told") return step === 0 ? "" : planText(history, step);
  if (team.assigned === NOBODY && !team.service) return reasonForRest(history, team, step);
  if (team.carries) return "it brings all that the load takes, and stays with it until it is unloaded";
  if (team.service) return "it brings all that the task needs, and stays until that is done";
  return [reasonForTask(history, team, step), planText(history, step)].filter(Boolean).join("; ");
}

function reasonForTask(history, team, step) {
  const task = team.assigned;
  const { steps } = history.record;
  const named = steps.slice(Math.max(0, step - 1), step).some((it) => it.named?.includes(team.slot));
  if (named) return "its policy named the task itself";
  const plan = sharedPlanAt(history, step);
  if (plan) return reasonInPlan(history, plan, team, task);
  const rank = orderAt(history, step).indexOf(task);
  if (rank < 0) return "";
  if (rank === 0) return "first in the order that everybody shares";
  return `${ordinal(rank)} in the order that everybody shares, the first it was sent to`;
}

// The shared plan that holds: {made, reasons, coalitions, scouts}, coalitions by task, scouts as
// [robot, the task it looks at first]; null without one. Like robots may have exchanged their parts since it was made.
export function sharedPlanAt({ record }, step) {
  const latest = (record.plans ?? []).findLast(([made]) => made <= step);
  if (!latest) return null;
  const [made, [reasons, planned]] = latest;
  const [, order] = record.orders.findLast(([at]) => at <= made);
  const parts = new Map();
  for (const { took = [] } of record.steps.slice(made, step)) {
    for (const [one, other] of took) {
      const [mine, theirs] = [parts.get(one) ?? one, parts.get(other) ?? other];
      parts.set(one, theirs).set(other, mine);
    }
  }
  const playedBy = new Map([...parts].map(([robot, part]) => [part, robot]));
  const robotsOf = (robots) => robots.map((robot) => playedBy.get(robot) ?? robot);
  const coalitions = new Map(order.map((task, at) => [task, robotsOf(planned[at])]));
  const [, looking = []] = (record.scouts ?? []).find(([at]) => at === made) ?? [];
  const scouts = looking.map(([robot, task]) => [playedBy.get(robot) ?? robot, task]);
  return { made, reasons, coalitions, scouts };
}

function reasonInPlan({ mission }, { coalitions, scouts }, team, task) {
  const looking = scouts.filter(([robot, at]) => at === task && team.robots.includes(robot));
  if (looking.length) return `the plan has ${listRobots(mission, looking.map(([it]) => it))} look first what it needs`;
  const robots = coalitions.get(task);
  if (!robots) return "";
  const names = listRobots(mission, robots);
  return robots.length > 1 ? `the plan has ${names} do it together` : `the plan has ${names} do it`;
}

// Who has no assignment: whether anything is left that its robots could help with.
function reasonForRest(history, team, step) {
  const { mission } = history;
  const all = mission.tasks.map((_, task) => task);
  const open = all.filter((task) => mission.tasks[task].appears <= step && !isOver(history, task, step));
  if (!open.length) return "no task is open";
  const plan = sharedPlanAt(history, step);
  const isWanted = ([task, robots]) =>
    !isOver(history, task, step) && robots.some((robot) => team.robots.includes(robot));
  if (plan) {
    const [next] = [...plan.coalitions].filter(isWanted);
    return next ? `the plan has it do ${taskName(mission, next[0])} next` : "the plan has nothing left for it";
  }
  const useful = open.filter((task) => needsAt(history, task, step).some(([cap]) => team.counts.has(cap)));
  if (!useful.length) return "no open task needs what it brings";
  const names = useful.slice(0, MANY).map((task) => taskName(mission, task));
  const more = useful.length > MANY ? ` and ${useful.length - MANY} more` : "";
  return `others are to do ${names.join(", ")}${more}`;
}

// When the plan or order that holds was made, and what made it anew.
function planText(history, step) {
  const made = latestPlan(history, step);
  if (!made) return "";
  const reasons = sharedPlanAt(history, step)?.reasons ?? [];
  const taken = reasons.includes("taken over") ? "a longer search was taken over" : "";
  const causes = [causesIn(history, made), taken].filter(Boolean).join(", ") || reasons.join(", ");
  if (made === 0) return "";
  const when = describeMoment(history.mission.world, made);
  return `planned anew ${history.mission.world.isPlane ? "at" : "after"} ${when}${causes ? `: ${causes}` : ""}`;
}

function latestPlan({ record }, step) {
  const kept = [record.orders, record.plans];
  const plans = kept.flatMap((rows) => rows ?? []).map(([made]) => made);
  return Math.max(0, ...plans.filter((made) => made <= step));
}

// What happened in the step after which a plan was made.
function causesIn(history, made) {
  const events = history.events.filter(({ step, kind }) => step === made && NEWS.includes(kind));
  return events.map((event) => describeEvent(history, event)).join(", ");
}

function ordinal(rank) {
  return ["first", "second", "third"][rank] ?? `number ${rank + 1}`;
}
