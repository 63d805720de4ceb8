"""Shared plans as graphs of arcs between tasks: from a situation to its graph, and back."""

from __future__ import annotations

import numpy as np

from teamformer.planning.arcs.annealing import ArcSearch
from teamformer.planning.arcs.graph import MAKESPAN, StepRules
from teamformer.planning.arcs.in_steps.meeting import TICKS
from teamformer.planning.continuous.problem import CoalitionProblem, Ticks, Whole, pose_problem
from teamformer.planning.continuous.schedule import CoalitionPlan, empty_plan
from teamformer.planning.relaxation.problem import Relaxed
from teamformer.planning.steps.crossings import Crossings
from teamformer.planning.steps.situation import Situation
from teamformer.planning.steps.team_plan import TeamPlan, plan_teams
from teamformer.rules.constants import FAR

RIDERS = 2
"""How many robots more than it needs come to a task at most."""

FEWEST_NEAR, MOST_NEAR, NEAR_SHARE = 14, 60, 7
"""How many tasks are near to each: every seventh, or two for each type of robots."""

HABITS = (30, 10, 5, 2, 15, 60, 40, 2 * TICKS)
"""Swaps, replacements, riders and so on, as `planning.arcs.graph` names them."""

LEAST_COOLING, MOST_COOLING, COOLING_SHARE = 8, 40, 10
"""Annealings begin at what a task takes a robot on average, divided by a tenth of the tasks."""

COOLER, LESS_HOT, COLD = 3, 2, 10
"""By how much cooler they begin at an old plan and at the best one so far, and end in any case."""

REHEATS, REHEATED = 2, 20  # percent
"""How often an annealing goes on from its best plan, each time for such a share of all rounds."""


def plan_from_arcs(
    situation: Situation, rounds: int, seed: int = 0, start: TeamPlan | None = None
) -> TeamPlan | None:
    """Return the best plan of so many rounds in all, which begin cool at a plan if one is given.

    Else an annealing goes on from its best plan, less hot. None if no first plan was found in which
    everybody gets where it has to be.
    """
    arcs = TeamArcs(situation, seed)
    if start is not None:
        arcs.begin_at(start)
        arcs.anneal(rounds, COOLER)
        return arcs.best
    if not arcs.begin_anew():
        return None
    reheated = rounds * REHEATED // 100
    arcs.anneal(rounds - REHEATS * reheated)
    for _ in range(REHEATS):
        arcs.search.begin_at_best()
        arcs.anneal(reheated, LESS_HOT)
    return arcs.best


class TeamArcs:
    """A search over graphs of arcs for plans of teams; robots of a team are in a row in it."""

    def __init__(self, situation: Situation, seed: int = 0) -> None:
        self.situation = situation
        self._robots = np.argsort(situation.company, kind="stable")  # those of the situation
        problem = _pose(situation, self._robots)
        tasks = len(problem.needs)
        teams = problem.ways.shape[1] - tasks
        leaders = np.unique(situation.company)
        passed, passes = _passes(situation.problem, situation.crossings, leaders)
        ready = situation.problem.ready[leaders].astype(np.int64) * TICKS
        assert teams == len(leaders)
        near = _near_of(tasks, len(np.unique(problem.counts, axis=0)))
        rules = StepRules(ready, near, RIDERS, HABITS, passed, passes)
        self.search = ArcSearch(problem, seed, rules)

    def begin_at(self, plan: TeamPlan) -> None:
        """Stand at a plan; robots that a task could do without are left out of large coalitions."""
        problem, most = self.search.problem, int(self.search.arcs.most[0])
        laid = empty_plan(problem)
        number = np.argsort(self._robots, kind="stable")
        laid.order[:] = plan.order
        for task, size in enumerate(plan.size.tolist()):
            robots = number[plan.coalition[task, :size]].tolist()
            kept = _at_most(problem, task, robots, most)
            laid.size[task], laid.coalition[task, : len(kept)] = len(kept), kept
        self.search.begin_at(laid)

    def begin_anew(self) -> bool:
        """Stand at a first plan; say whether robots can get to all tasks as it wants."""
        is_able = self.search.begin_anew()
        return is_able and self.search.graph.total[MAKESPAN] < FAR * TICKS

    def anneal(self, rounds: int, cooler: int = 1) -> None:
        """Make so many rounds, from hot to cold, or from so many times less than hot."""
        hot, cold = self.heats
        self.search.anneal(hot // cooler, cold, 0, rounds, rounds)

    @property
    def heats(self) -> tuple[int, int]:
        """Return where an annealing begins and ends: with more tasks it may be colder."""
        tasks = len(self.situation.tasks)
        hot = self.search.leg // max(LEAST_COOLING, min(MOST_COOLING, tasks // COOLING_SHARE))
        return hot, hot // COLD

    @property
    def best(self) -> TeamPlan:
        """Return the best plan."""
        return self._team_plan(self.search.best)

    def _team_plan(self, plan: CoalitionPlan) -> TeamPlan:
        coalitions = [
            self._robots[row[:size]].tolist()
            for row, size in zip(plan.coalition, plan.size, strict=True)
        ]
        return plan_teams(self.situation.problem, plan.order.tolist(), coalitions)


def _near_of(tasks: int, types: int) -> int:
    """Return how many tasks are near to each: more where robots are of many types."""
    return min(tasks - 1, MOST_NEAR, max(FEWEST_NEAR, tasks // NEAR_SHARE, 2 * types))


def _pose(situation: Situation, robots: Ticks) -> CoalitionProblem:
    """Return a situation as a coalition problem: depots are teams, nobody goes home."""
    problem = situation.problem
    tasks = len(problem.appears)
    leaders, origin = np.unique(situation.company, return_inverse=True)
    places = np.concatenate([np.arange(tasks), tasks + leaders])
    steps = problem.steps[:, problem.cells[:, places]]  # (paces, tasks, places)
    ways = np.ascontiguousarray(steps.transpose(0, 2, 1), np.int64) * TICKS
    return pose_problem(
        ways=ways,
        home=np.zeros((len(robots), len(places)), np.int64),
        pace=problem.pace[robots],
        origin=tasks + origin[robots],
        counts=problem.counts[robots],
        needs=problem.needs,
        duration=problem.duration.astype(np.int64) * TICKS,
        release=(problem.appears.astype(np.int64) + 1) * TICKS,
        forming=situation.forming_steps,
    )


def _passes(problem: Relaxed, crossings: Crossings, leaders: Ticks) -> tuple[Whole, Whole]:
    """Return the tasks that take time and lie on the way from each place to each task."""
    tasks = len(problem.appears)
    if not len(crossings.task):
        return np.zeros(1, np.int32), np.zeros(0, np.int32)
    takes_time = problem.duration[crossings.task] > 0
    number = np.concatenate([[0], np.cumsum(takes_time)])
    first = number[crossings.first]  # of all places
    places = np.concatenate([np.arange(tasks), tasks + leaders])
    begin = first[:-1].reshape(-1, tasks)[places].ravel()
    end = first[1:].reshape(-1, tasks)[places].ravel()
    kept = crossings.task[takes_time]
    passes = np.concatenate([kept[a:b] for a, b in zip(begin, end, strict=True)] or [kept[:0]])
    passed = np.concatenate([[0], np.cumsum(end - begin)])
    return passed.astype(np.int32), passes.astype(np.int32)


def _at_most(problem: CoalitionProblem, task: int, robots: list[int], most: int) -> list[int]:
    """Return robots of a coalition, so many at most, that cover its task."""
    kept, index = list(robots), len(robots) - 1
    while len(kept) > most and index >= 0:
        rest = [*kept[:index], *kept[index + 1 :]]
        if (problem.counts[rest].sum(axis=0) >= problem.needs[task]).all():
            kept = rest
        index -= 1
    return kept
