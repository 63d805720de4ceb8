// The shared plan that holds at some step: which robots do which task together.

// Coalitions by task; null without a plan. Like robots may have exchanged their parts since it was made.
/** @returns {Map<number, number[]> | null} */
export function sharedPlanAt(/** @type {TrialHistory} */ { record }, step) {
  const latest = (record.plans ?? []).findLast(([made]) => made <= step);
  if (!latest) return null;
  const [made, [, planned]] = latest;
  const [, order] = record.orders.findLast(([at]) => at <= made) ?? [0, []];
  const parts = new Map();
  for (const { took = [] } of record.steps.slice(made, step)) {
    for (const [one, other] of took) {
      const [mine, theirs] = [parts.get(one) ?? one, parts.get(other) ?? other];
      parts.set(one, theirs).set(other, mine);
    }
  }
  const playedBy = new Map([...parts].map(([robot, part]) => [part, robot]));
  return new Map(order.map((task, at) => [task, planned[at].map((robot) => playedBy.get(robot) ?? robot)]));
}
