"""The plan that every robot works out alike: who does which task with whom, in what order.

It is a pure function of what everybody knows: no clock, a fixed number of rounds, a fixed seed,
whole numbers. So all robots, on any processor, find the same plan.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from teamformer.model import Scenario
from teamformer.planning.teams.facts import Facts, SharedPlan, Situation, situation_of
from teamformer.planning.teams.plan import TeamPlan
from teamformer.planning.teams.starts import complete_plan, plan_from_coalitions, plan_from_crews
from teamformer.planning.teams.threshold_search import ThresholdSearch

HOT = 0.5
"""How many steps of makespan a plan may be worse at first in the search."""

TRIED = 8
"""From each start an eighth of the rounds is searched, and all of them from the best."""

SMALLEST_GAIN = 50
"""The part of the steps left that a new plan must gain for anybody to turn round: a fiftieth."""


class Rounds(NamedTuple):
    """How long to search: for lists of crews, without forming counted, and with."""

    crews: int
    relaxed: int
    team: int


def rounds_for(robots: int, tasks: int, is_again: bool) -> Rounds:
    """Return the rounds for a mission of a size: fixed, as a clock would not be the same for all.

    A second of one core for 16 robots and 60 tasks, a fifth of that when planned again.
    """
    crews = 1500 * tasks
    relaxed = max(1, min(3 * tasks * tasks, 18_000_000 // (tasks * (tasks + robots))))
    team = min(100 * tasks * tasks, 120_000)
    if is_again:
        return Rounds(crews // 5, 1 + relaxed // 5, team // 5)
    return Rounds(crews, relaxed, team)


def plan_mission(scenario: Scenario, facts: Facts, old: SharedPlan | None = None) -> SharedPlan:
    """Return the plan from the present on; never worse by its own count than the old one.

    Robots that will be lost and tasks that have not appeared play no part.
    """
    if not facts.open_tasks:
        return SharedPlan((), (), (), "nothing")
    situation = situation_of(scenario, facts)
    rounds = rounds_for(len(situation.robots), len(situation.tasks), old is not None)
    kept = None if old is None else _kept(situation, old)
    best, chosen = None, ""
    for name, start in _starts(situation, rounds, kept):
        search = _search_from(situation, start)
        search.run(rounds.team // TRIED, HOT)
        if best is None or search.cost < best.cost:
            best, chosen = search, name
    assert best is not None  # crews can do every task that can be done
    best.run(rounds.team, HOT)
    if kept is not None:
        unchanged = _search_from(situation, kept)
        left = unchanged.makespan - facts.step
        if best.makespan + left // SMALLEST_GAIN >= unchanged.makespan:
            best, chosen = unchanged, "kept"
    return _plan_of(situation, best, chosen)


def _starts(
    situation: Situation, rounds: Rounds, kept: TeamPlan | None
) -> Iterator[tuple[str, TeamPlan]]:
    """Return the plans that the search begins with, by name."""
    if kept is not None:
        yield "old plan", kept
    yield "crews", plan_from_crews(situation.problem, situation.company, rounds.crews)
    relaxed = plan_from_coalitions(situation.problem, rounds.relaxed)
    if relaxed is not None:
        yield "coalitions", relaxed


def _search_from(situation: Situation, start: TeamPlan) -> ThresholdSearch:
    search = ThresholdSearch(
        situation.problem, situation.crossings, situation.company, situation.forming_steps
    )
    search.begin(start)
    return search


def _kept(situation: Situation, old: SharedPlan) -> TeamPlan:
    """Return what is left of an old plan, with new tasks at its end."""
    number = {robot: index for index, robot in enumerate(situation.robots)}
    place = {task: index for index, task in enumerate(situation.tasks)}
    order = [place[task] for task in old.order if task in place]
    coalitions: list[list[int]] = [[] for _ in situation.tasks]
    for task, robots in zip(old.order, old.coalitions, strict=True):
        if task in place:
            coalitions[place[task]] = [number[robot] for robot in robots if robot in number]
    order += [task for task in range(len(coalitions)) if task not in set(order)]
    return complete_plan(situation.problem, order, coalitions)


def _plan_of(situation: Situation, search: ThresholdSearch, start: str) -> SharedPlan:
    """Return what a search found in the numbers of the mission."""
    plan, ends = search.best, search.ends
    order = plan.order.tolist()
    return SharedPlan(
        order=tuple(situation.tasks[task] for task in order),
        coalitions=tuple(
            tuple(situation.robots[robot] for robot in sorted(plan.crew[task, : plan.size[task]]))
            for task in order
        ),
        ends=tuple(int(ends[task]) for task in order),
        start=start,
    )
