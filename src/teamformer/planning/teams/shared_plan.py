"""The plan that every robot works out alike: who does which task with whom, in what order.

It is a pure function of what everybody knows: no clock, a fixed number of rounds, a fixed seed,
whole numbers. So all robots, on any processor, find the same plan.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

from teamformer.model import Scenario
from teamformer.planning.relaxation.problem import Relaxed
from teamformer.planning.teams.facts import (
    Facts,
    SharedPlan,
    Situation,
    possible_tasks,
    situation_of,
)
from teamformer.planning.teams.plan import TeamPlan
from teamformer.planning.teams.starts import complete_plan, plan_from_coalitions, plan_from_crews
from teamformer.planning.teams.threshold_search import ThresholdSearch

HOT = 0.5
"""How many steps of makespan a plan may be worse at first in the search."""

CREWS, COALITIONS = "crews", "coalitions"
"""What a plan is made from: what crews do, or coalitions that are best where joining is free."""

CLEARLY = 16
"""Crews are clearly better if coalitions cost a sixteenth more."""

SEEDS = 6
"""How often coalitions are looked for, where crews are not clearly better."""

CREW_SEARCHES = (8, 20)
"""How long crews are looked for again where they are, in tenths of the first time."""

FIRST_LAP = 16
"""Which part of the rounds is searched from every start: a sixteenth."""

LAPS = ((3, 8), (2, 4), (1, 2))
"""How many of the best searches go on after that, and for which part of the rounds."""

MOST_AT_ONCE = 10_000_000
"""A mission with more tasks times tasks and robots is too large to be planned while one waits."""

SMALLEST_GAIN = 50
"""The part of the steps left that a new plan must gain for anybody to turn round: a fiftieth."""


BRIEF = 4
"""A brief search is so much shorter, and begins with one plan of each kind."""


class Rounds(NamedTuple):
    """How long to search: for lists of crews, each time without forming counted, and with."""

    crews: int
    relaxed: int
    team: int


def rounds_for(problem: Relaxed, is_again: bool) -> Rounds:
    """Return the rounds for a mission of a size: fixed, as a clock would not be the same for all.

    A second or two of one core for 16 robots and 60 tasks, a fifth of that when planned again.
    """
    tasks, robots = len(problem.appears), len(problem.pace)
    size = tasks * (tasks + robots)
    crews = 1500 * tasks
    relaxed = min(3 * tasks * tasks, 18_000_000 // size) // 2
    team = min(100 * tasks * tasks, max(70_000, 1200 * tasks), 120_000)
    team = min(team, 900_000_000_000 // (tasks * size))  # what timing a plan takes grows so
    team = min(team, 1_200_000_000 // (int(problem.needs.sum()) * problem.needs.shape[1]))
    if is_again:
        return Rounds(crews // 5, 1 + relaxed // 5, team // 5)
    return Rounds(crews, relaxed, team)


def is_too_large(scenario: Scenario) -> bool:
    """Say whether a shared plan would take too long to wait for; crews are planned sooner."""
    tasks = len(scenario.tasks)
    return tasks * (tasks + len(scenario.robots)) > MOST_AT_ONCE


def plan_mission(
    scenario: Scenario, facts: Facts, old: SharedPlan | None = None, is_brief: bool = False
) -> SharedPlan:
    """Return the plan from the present on; never worse by its own count than the old one.

    Robots that will be lost or back and tasks that have not appeared play no part; what the robots
    that are left cannot do is not in the plan. `is_brief` is for those who plan again often.
    """
    facts = replace(facts, open_tasks=possible_tasks(scenario, facts))
    if not facts.open_tasks:
        return SharedPlan((), (), (), "nothing")
    situation = situation_of(scenario, facts)
    rounds = rounds_for(situation.problem, old is not None)
    if is_brief:
        rounds = Rounds(rounds.crews // BRIEF, rounds.relaxed, rounds.team // BRIEF)
    kept = None if old is None else kept_plan(situation, old)
    entered = [
        _enter(situation, rounds, *start) for start in _first_starts(situation, rounds, kept)
    ]
    if not is_brief:
        crews_are_better = _are_crews_better(entered[kept is not None :])
        more = _more_starts(situation, rounds, crews_are_better)
        entered += [_enter(situation, rounds, *start) for start in more]
    chosen, best = _race(entered, rounds)
    if kept is not None:
        unchanged = _search_from(situation, kept)
        left = unchanged.makespan - facts.step
        if best.makespan + left // SMALLEST_GAIN >= unchanged.makespan:
            best, chosen = unchanged, "kept"
    return shared_plan_of(situation, best, chosen)


class _Entered(NamedTuple):
    """A search that takes part in the race, and what it began with."""

    name: str
    search: ThresholdSearch


def _cost_of(entered: _Entered) -> int:
    return entered.search.cost


def _enter(situation: Situation, rounds: Rounds, name: str, start: TeamPlan) -> _Entered:
    """Search for a while from a plan."""
    search = _search_from(situation, start)
    search.run(rounds.team // FIRST_LAP, HOT)
    return _Entered(name, search)


def _race(entered: list[_Entered], rounds: Rounds) -> _Entered:
    """Let the best searches go on, fewer and fewer of them, and return the best."""
    for number, part in LAPS:
        entered = sorted(entered, key=_cost_of)[:number]
        for _, search in entered:
            search.run(rounds.team // part, HOT)
    return min(entered, key=_cost_of)


def _are_crews_better(fresh: list[_Entered]) -> bool:
    """Say whether crews are clearly better than coalitions, or there are no coalitions."""
    crews, *coalitions = map(_cost_of, fresh)
    return all(cost > crews + crews // CLEARLY for cost in coalitions)


def _first_starts(
    situation: Situation, rounds: Rounds, kept: TeamPlan | None
) -> Iterator[tuple[str, TeamPlan]]:
    """Return a plan of each kind that the search begins with, the old one first."""
    if kept is not None:
        yield "old plan", kept
    yield CREWS, plan_from_crews(situation.problem, situation.company, rounds.crews)
    if rounds.relaxed >= len(situation.tasks):
        relaxed = plan_from_coalitions(situation.problem, rounds.relaxed)
        if relaxed is not None:
            yield COALITIONS, relaxed


def _more_starts(
    situation: Situation, rounds: Rounds, crews_are_better: bool
) -> Iterator[tuple[str, TeamPlan]]:
    """Return more plans of the better kind: several searches find more than a long one."""
    if crews_are_better:
        for longer in CREW_SEARCHES:
            crews = rounds.crews * longer // 10
            yield CREWS, plan_from_crews(situation.problem, situation.company, crews)
    else:
        for seed in range(1, SEEDS):
            relaxed = plan_from_coalitions(situation.problem, rounds.relaxed, seed)
            if relaxed is not None:
                yield COALITIONS, relaxed


def _search_from(situation: Situation, start: TeamPlan) -> ThresholdSearch:
    search = ThresholdSearch(
        situation.problem, situation.crossings, situation.company, situation.forming_steps
    )
    search.begin(start)
    return search


def kept_plan(situation: Situation, old: SharedPlan) -> TeamPlan:
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


def shared_plan_of(situation: Situation, search: ThresholdSearch, start: str) -> SharedPlan:
    """Return what a search found in the numbers of the mission."""
    plan, ends = search.best, search.ends
    order = plan.order.tolist()
    return SharedPlan(
        order=tuple(situation.tasks[task] for task in order),
        coalitions=tuple(
            tuple(situation.robots[r] for r in sorted(plan.coalition[task, : plan.size[task]]))
            for task in order
        ),
        ends=tuple(int(ends[task]) for task in order),
        start=start,
    )
