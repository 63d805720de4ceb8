"""The shared plan where nobody knows yet what tasks need: the best on average that is found.

It begins with the plan for what is needed at most or with the old one, whichever costs less on
average over sampled futures, and changes that as long as it costs no more. All robots sample the
same futures and try the same changes, so that they find the same plan.
"""

from __future__ import annotations

from collections.abc import Set
from dataclasses import dataclass, replace

import numpy as np

from teamformer.grid import Grid
from teamformer.model import Scenario
from teamformer.planning.foresight.futures import sample_futures
from teamformer.planning.foresight.ground import empty_stage, ground_of
from teamformer.planning.foresight.mean_search import amend, improve_on_average
from teamformer.planning.relaxation.plan import Array
from teamformer.planning.teams.facts import (
    Facts,
    SharedPlan,
    Situation,
    possible_tasks,
    situation_of,
)
from teamformer.planning.teams.neighbourhood import empty_bench
from teamformer.planning.teams.plan import TeamPlan
from teamformer.planning.teams.shared_plan import plan_in_numbers, plan_mission
from teamformer.planning.teams.starts import complete_plan
from teamformer.planning.teams.timing import ENDLESS, empty_groups, time_plan
from teamformer.rules.constants import NOBODY


@dataclass(frozen=True)
class Sampling:
    """How much is looked at: futures, changes at the start and at events, whether there are scouts.

    Larger missions are given fewer changes: what a play takes grows with tasks times tasks times
    robots, and no more than `work` of these is played in each of the futures.
    """

    futures: int = 24
    rounds: int = 1500
    rounds_again: int = 150
    work: int = 50_000_000
    scouts: bool = True


SAMPLING = Sampling()

FEWEST_ROUNDS = 10
"""A mission that is given fewer changes than this is not looked ahead in."""


def plan_ahead(
    scenario: Scenario,
    believed: Scenario,
    facts: Facts,
    hidden: Set[int],
    old: SharedPlan | None,
    sampling: Sampling = SAMPLING,
) -> SharedPlan:
    """Return the plan from the present on; of `hidden` tasks nobody has seen what they need.

    `believed` is the mission with what its tasks need at most. Where nothing is hidden, on planes
    and for large missions it is the plan for that.
    """
    facts = replace(facts, open_tasks=possible_tasks(believed, facts))
    planned = plan_mission(believed, facts, old)
    unseen = hidden & set(facts.open_tasks)
    rounds = _rounds_for(sampling, facts, old is not None)
    if not unseen or rounds < FEWEST_ROUNDS or not isinstance(scenario.world, Grid):
        return planned
    situation = situation_of(_with_sure_needs(scenario, believed, unseen), facts)
    most = situation_of(believed, facts).problem.needs.astype(np.int64)  # (tasks, caps)
    ground = ground_of(believed, situation, facts, unseen)
    stage = empty_stage(ground)
    futures = sample_futures(scenario, situation, most, unseen, facts.step, sampling.futures)
    costs = np.zeros((2, sampling.futures), np.int64)
    starts = []
    if old is not None:
        starts.append(_in_numbers(situation, ground.is_hidden, old))
        amend(ground, *starts[0], most, stage)
    starts.append(_in_numbers(situation, ground.is_hidden, planned))
    bench = empty_bench(situation.problem, facts.step)
    room = (futures, stage, bench, costs)
    total = [
        improve_on_average(ground, situation.problem, *start, *room, 0, False) for start in starts
    ]
    plan, scouts = starts[int(np.argmin(total))]
    improve_on_average(ground, situation.problem, plan, scouts, *room, rounds, sampling.scouts)
    return _shared_plan(situation, plan, scouts, planned.start)


def _rounds_for(sampling: Sampling, facts: Facts, is_again: bool) -> int:
    """Return how many changes are tried: fixed, as a clock would not be the same for all."""
    tasks, robots = len(facts.open_tasks), sum(len(team) for team in facts.teams)
    affordable = sampling.work // max(1, tasks * tasks * robots)
    if is_again:
        return min(sampling.rounds_again, affordable // 10)
    return min(sampling.rounds, affordable)


def _with_sure_needs(scenario: Scenario, believed: Scenario, hidden: Set[int]) -> Scenario:
    """Return a mission in which hidden tasks need what is sure only."""
    tasks = tuple(
        replace(task, needs=scenario.tasks[number].needs) if number in hidden else task
        for number, task in enumerate(believed.tasks)
    )
    return replace(believed, tasks=tasks)


def _in_numbers(situation: Situation, is_hidden: Array, plan: SharedPlan) -> tuple[TeamPlan, Array]:
    """Return a plan and its scouts, (robots,), in the numbers of a situation.

    Coalitions have at least what is sure; what is new comes last.
    """
    number = {robot: index for index, robot in enumerate(situation.robots)}
    place = {task: index for index, task in enumerate(situation.tasks)}
    order, coalitions = plan_in_numbers(situation, plan)
    scouts = np.full(len(number), NOBODY, np.int64)
    for robot, task in plan.scouts:
        if robot in number and task in place and is_hidden[place[task]]:
            scouts[number[robot]] = place[task]
    return complete_plan(situation.problem, order, coalitions), scouts


def _shared_plan(situation: Situation, plan: TeamPlan, scouts: Array, start: str) -> SharedPlan:
    """Return a plan in the numbers of the mission, timed as if nothing showed on the way."""
    problem, order = situation.problem, plan.order.tolist()
    groups = empty_groups(problem, situation.company, situation.forming_steps)
    time_plan(problem, situation.crossings, plan, groups, np.int64(ENDLESS))
    return SharedPlan(
        order=tuple(situation.tasks[task] for task in order),
        coalitions=tuple(
            tuple(situation.robots[r] for r in sorted(plan.coalition[task, : plan.size[task]]))
            for task in order
        ),
        ends=tuple(int(groups.end[task]) for task in order),
        start=start,
        scouts=tuple(
            (situation.robots[robot], situation.tasks[int(scouts[robot])])
            for robot in np.flatnonzero(scouts != NOBODY).tolist()
        ),
    )
