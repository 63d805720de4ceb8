"""Shared plans as graphs of arcs between tasks: from a situation to its graph, and back."""

from __future__ import annotations

import numpy as np

from teamformer.base.array_types import Array, Int32s, Ints
from teamformer.planning.graph.arc_problem import StepRules
from teamformer.planning.graph.graph import MAKESPAN
from teamformer.planning.problem.coalition_plan import (
    CoalitionPlan,
    empty_plan,
    keep_order,
    pairs_before,
    plan_of_lists,
)
from teamformer.planning.problem.coalition_problem import (
    CoalitionProblem,
    different_rows,
    pose_problem,
)
from teamformer.planning.problem.constants import TICKS
from teamformer.planning.problem.misses import Misses, can_miss
from teamformer.planning.problem.permits import (
    Permits,
    block,
    deal_permits,
    no_permits,
    that_bind,
    without_permits,
)
from teamformer.planning.problem.prices import STEP
from teamformer.planning.problem.relaxed_problem import Relaxed, cost_of_step, has_prices
from teamformer.planning.problem.rotas import of_kinds, stretched, with_others
from teamformer.planning.search.arc_search import ArcSearch
from teamformer.planning.step_times.crossings import Crossings
from teamformer.planning.steps.situation import Situation
from teamformer.planning.steps.timed_plan import TimedPlan, time_team_plan
from teamformer.world.rules.constants import FAR, NOBODY

RIDERS, RIDERS_IF_LARGE = 4, 2
"""How many robots more than it needs come to a task at most."""

FEWEST_NEAR, MOST_NEAR, NEAR_SHARE = 14, 60, 7
"""How many tasks are near to each: every seventh, or two for each type of robots."""

LARGE = 100
"""Missions of so many tasks are planned from an empty plan, not from coalitions."""

STEP_OF_SEARCH = 100
"""What a step of makespan costs in a graph, for each task, where that alone counts."""

COOL = 20
"""An annealing at a plan begins at what a task takes a robot on average, divided by this."""

LEAST_COOLING, MOST_COOLING, COOLING_SHARE = 8, 40, 10
"""One that begins anew does so at that, divided by a tenth of the tasks."""

LESS_HOT, COLD = 2, 10
"""By how much cooler that goes on at its best plan, and how much cooler any ends."""

REHEATS, REHEATED = 2, 20  # percent
"""How often it goes on from its best plan, each time for such a share of all rounds."""


class TeamArcs:
    """A search over graphs of arcs for plans of teams; robots of a team are in a row in it."""

    def __init__(self, situation: Situation, seed: int = 0) -> None:
        self.situation = situation
        self._robots = np.argsort(situation.company, kind="stable")  # those of the situation
        tasks = len(situation.tasks)
        is_large = tasks >= LARGE
        riders = RIDERS_IF_LARGE if is_large else RIDERS
        permits = that_bind(situation.problem.permits, int(situation.problem.ready.min()))
        problem = pose_steps(situation, self._robots, riders, permits)
        leaders = np.unique(situation.company)
        passed, passes = _passes(situation.problem, situation.crossings, leaders)
        rules = StepRules(
            lost=_padded(situation.problem.lost[self._robots], permits.number, FAR),
            together=_together(situation.problem, permits),
            prices=situation.problem.prices,
            near=_near_of(tasks, len(np.unique(problem.counts, axis=0))),
            is_large=is_large,
            passed=passed,
            passes=passes,
        )
        self.search = ArcSearch(problem, seed, rules)

    def improve(self, timed: TimedPlan, rounds: int) -> TimedPlan:
        """Return the better one of a plan and the best found from it in so many rounds."""
        self.begin_at(timed.plan)
        hot = self.search.leg // COOL
        self.search.anneal(hot, hot // COLD, 0, rounds, rounds)
        return min(timed, self.best, key=rank_of)

    def plan_anew(self, rounds: int) -> TimedPlan | None:
        """Return the best plan found in so many rounds from an empty plan.

        None if there is no first plan in which everybody gets where it has to be.
        """
        if not self.begin_anew():
            return None
        hot, cold = self.heats
        reheated = rounds * REHEATED // 100
        most = rounds - REHEATS * reheated
        self.search.anneal(hot, cold, 0, most, most)
        for _ in range(REHEATS):
            self.search.begin_at_best()
            self.search.anneal(hot // LESS_HOT, cold, 0, reheated, reheated)
        return self.best

    def begin_at(self, plan: CoalitionPlan) -> None:
        """Stand at a plan; robots that a task could do without are left out of large coalitions."""
        laid = empty_plan(self.search.problem)
        number = np.argsort(self._robots, kind="stable")
        laid.order[:] = keep_order(self.situation.problem.before, plan.order.tolist())
        for task, size in enumerate(plan.size.tolist()):
            robots = number[plan.coalition[task, :size]].tolist()
            laid.size[task], laid.coalition[task, :size] = size, robots
        if self.search.problem.bodies < len(self.search.problem.counts):
            ends = time_team_plan(self.situation, plan).ends * TICKS
            deal_permits(self.search.problem, laid, dict(enumerate(ends.tolist())))
        self.search.begin_at(laid)

    def begin_anew(self) -> bool:
        """Stand at a first plan; say whether robots can get to all tasks as it wants."""
        is_able = self.search.begin_anew()
        return is_able and self.search.graph.total[MAKESPAN] < FAR * TICKS

    @property
    def heats(self) -> tuple[int, int]:
        """Return where an annealing from an empty plan begins and ends: colder with more tasks."""
        tasks = len(self.situation.tasks)
        hot = self.search.leg // max(LEAST_COOLING, min(MOST_COOLING, tasks // COOLING_SHARE))
        return hot, hot // COLD

    @property
    def best(self) -> TimedPlan:
        """Return the best plan, timed."""
        return time_team_plan(self.situation, self.plan)

    @property
    def plan(self) -> CoalitionPlan:
        """Return the best plan as the graph has it: tasks are done by those who are led to them."""
        plan = without_permits(self.search.problem, self.search.best)
        coalitions = [
            self._robots[row[:size]].tolist()
            for row, size in zip(plan.coalition, plan.size, strict=True)
        ]
        return plan_of_lists(plan.order.tolist(), coalitions)


def rank_of(timed: TimedPlan) -> tuple[int, int]:
    """Return what plans are compared by."""
    return timed.rank


def _near_of(tasks: int, types: int) -> int:
    """Return how many tasks are near to each: more where robots are of many types."""
    return min(tasks - 1, MOST_NEAR, max(FEWEST_NEAR, tasks // NEAR_SHARE, 2 * types))


def pose_steps(
    situation: Situation, robots: Ints, riders: int, permits: Permits | None = None
) -> CoalitionProblem:
    """Return a situation as a coalition problem, its robots in an order: depots are teams.

    Nobody goes home. With `permits`, which are behind robots, it has room in zones; each has a
    depot of its own.
    """
    problem = situation.problem
    permits = no_permits(len(problem.appears)) if permits is None else permits
    new, one = permits.number, min(1, permits.number)
    tasks, carried = len(problem.appears), problem.steps[:, problem.carry]  # (paces, tasks)
    leaders, origin = np.unique(situation.company, return_inverse=True)
    rotas, lost = problem.rotas, problem.lost[robots]
    apart = lost
    if len(rotas.every):  # robots with other shifts are of other kinds
        shifts = rotas.shifts[robots].reshape(len(robots), -1)
        _, apart = different_rows(np.column_stack([lost, shifts, rotas.every[robots]]))
    rotas = with_others(of_kinds(stretched(rotas, TICKS), robots), new)
    places = np.concatenate([np.arange(tasks), tasks + leaders])
    steps = problem.steps[:, problem.cells[:, places]]  # (paces, tasks, places)
    ways = np.ascontiguousarray(steps.transpose(0, 2, 1), np.int64) * TICKS
    slower = np.maximum(0, carried - problem.quickest).astype(np.int64) * TICKS
    starts = [*problem.ready[leaders], *permits.free]
    return pose_problem(
        ways=np.pad(ways, ((0, one), (0, new), (0, 0))),
        home=np.zeros((len(robots) + new, len(places) + new), np.int64),
        pace=_padded(problem.pace[robots], new, len(problem.steps)),
        origin=[*tasks + origin[robots], *range(len(places), len(places) + new)],
        counts=block(problem.counts[robots], permits.counts),
        needs=np.hstack([problem.needs, permits.needs]),
        duration=problem.duration.astype(np.int64) * TICKS,
        slower=np.pad(slower, ((0, one), (0, 0))),
        release=(problem.appears.astype(np.int64) + 1) * TICKS,
        precedence=pairs_before(problem.before),
        forming=situation.forming_steps,
        apart=_padded(apart, new, NOBODY),
        spares=riders,
        ready=np.array(starts, np.int64) * TICKS,
        rotas=rotas,
        misses=_misses_in_ticks(problem),
        permits=new,
    )


def _padded(values: Array, more: int, value: int) -> Ints:
    """Return what robots have, with what permits have behind it."""
    return np.append(values, np.full(more, value)).astype(np.int64)


def _misses_in_ticks(problem: Relaxed) -> Misses:
    """Return what is missed of tasks that end after a step, whatever their place in it."""
    misses = problem.misses
    if not can_miss(misses):
        return misses
    leads = np.maximum(1, misses.leads * TICKS // cost_of_step(problem))
    until = (misses.until + 1) * TICKS - 1
    scale = 1 if has_prices(problem) else STEP // STEP_OF_SEARCH
    return misses._replace(until=until, judged=misses.judged // scale * TICKS, leads=leads)


def _together(problem: Relaxed, permits: Permits) -> Int32s:
    """Return the pace of those who go together, (paces, paces); permits never do."""
    movers = len(problem.lengths)
    flies, rank = np.divmod(np.arange(len(problem.steps)), len(problem.steps) // movers)
    both_fly, slowest = np.minimum.outer(flies, flies), np.minimum.outer(rank, rank)
    together: Int32s = (both_fly * (len(problem.steps) // movers) + slowest).astype(np.int32)
    return np.pad(together, (0, min(1, permits.number)))


def _passes(problem: Relaxed, crossings: Crossings, leaders: Ints) -> tuple[Int32s, Int32s]:
    """Return the tasks that take time and lie on the way from each place to each task."""
    tasks = len(problem.appears)
    if not len(crossings.task):
        return np.zeros(1, np.int32), np.zeros(0, np.int32)
    is_passed = (problem.duration[crossings.task] > 0) & (crossings.cells > 0)
    number = np.concatenate([[0], np.cumsum(is_passed)])
    first = number[crossings.first]  # of all places
    places = np.concatenate([np.arange(tasks), tasks + leaders])
    begin = first[:-1].reshape(-1, tasks)[places].ravel()
    end = first[1:].reshape(-1, tasks)[places].ravel()
    kept = crossings.task[is_passed]
    passes = np.concatenate([kept[a:b] for a, b in zip(begin, end, strict=True)] or [kept[:0]])
    passed = np.concatenate([[0], np.cumsum(end - begin)])
    return passed.astype(np.int32), passes.astype(np.int32)
