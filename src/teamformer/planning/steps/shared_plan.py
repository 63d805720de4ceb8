"""The plan that every robot works out alike: who does which task with whom, in what order.

It is a pure function of what everybody knows: no clock, a fixed number of rounds, a fixed seed,
whole numbers. So all robots, on any processor, find the same plan.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from teamformer.coordination import Known, Plan
from teamformer.model import Scenario
from teamformer.planning.relaxation.problem import Relaxed, has_prices, most_in_coalitions
from teamformer.planning.steps.arc_search import plan_from_arcs
from teamformer.planning.steps.situation import Situation, plan_of, situation_of
from teamformer.planning.steps.starts import complete_plan, plan_from_coalitions, plan_from_crews
from teamformer.planning.steps.team_plan import TeamPlan
from teamformer.planning.steps.threshold_search import ThresholdSearch

HOT = 0.5
"""How many steps of makespan a plan may be worse at first in the search."""

CREWS, COALITIONS = "crews", "coalitions"
"""What a plan is made from: what crews do, or coalitions that are best where joining is free."""

CLEARLY = 16
"""Crews are clearly better if plans from coalitions take a sixteenth longer."""

HOPELESS = 4
"""Crews are not searched from at all if they take a quarter longer to begin with."""

GLANCE = 20
"""A brief search over graphs of arcs is so much shorter."""

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

LARGE = 100
"""Missions of so many tasks are searched once over graphs of arcs, and not on from there."""

ARC_ROUNDS, ROUNDS_TIMES_TASKS = 900_000, 210_000_000
"""Rounds over graphs of arcs; what is made of these times tasks at most, as rounds take longer."""

PRICED = 2
"""By how much longer orders of tasks are searched where more counts than the makespan."""

BRIEF = 4
"""A brief search is so much shorter, and begins with one plan of each kind."""


class Rounds(NamedTuple):
    """How long to search: for lists of crews, for coalitions each time, and over orders of tasks.

    `coalitions` is how often they are searched for where crews are not clearly better: in a large
    mission once, over graphs of arcs, else with forming not counted.
    """

    crews: int
    coalition: int
    team: int
    coalitions: int


def rounds_for(problem: Relaxed, is_again: bool) -> Rounds:
    """Return the rounds for a mission of a size: fixed, as a clock would not be the same for all.

    A second of one core for 16 robots and 60 tasks, a fifth of that when planned again; some three
    seconds for 100 robots and 300 tasks.
    """
    tasks, needs = len(problem.appears), int(most_in_coalitions(problem).sum())
    crews = 1500 * tasks
    team = min(100 * tasks * tasks, max(60_000, 1000 * tasks), 120_000)
    team = min(team, 15_000_000 // tasks)  # what timing a plan takes grows so
    team = min(team, 1_200_000_000 // (needs * problem.needs.shape[1]))
    if has_prices(problem):
        team *= PRICED
    if tasks >= LARGE and not has_prices(problem):
        coalition, coalitions = min(ARC_ROUNDS, ROUNDS_TIMES_TASKS // tasks), 1
    else:
        coalition, coalitions = relaxed_rounds(problem), 3 if is_again else 6
    if is_again:
        return Rounds(crews // 5, 1 + coalition // 5, team // 5, coalitions)
    return Rounds(crews, coalition, team, coalitions)


def relaxed_rounds(problem: Relaxed) -> int:
    """Return how long coalitions are searched for with forming not counted."""
    tasks, needs = len(problem.appears), int(most_in_coalitions(problem).sum())
    return min(3 * tasks * tasks // 2, 130_000 // (tasks + 10 * needs // tasks))


def is_too_large(scenario: Scenario) -> bool:
    """Say whether a shared plan would take too long to wait for; crews are planned sooner."""
    tasks = len(scenario.tasks)
    return tasks * (tasks + len(scenario.robots)) > MOST_AT_ONCE


def plan_mission(known: Known, old: Plan | None = None, is_brief: bool = False) -> Plan:
    """Return the plan from the present on; never worse by its own count than the old one.

    Robots that will be lost or back and tasks that have not appeared play no part; what the robots
    that are left cannot do is not in the plan. `is_brief` is for those who plan again often: fewer
    searches, and shorter ones.
    """
    if not known.possible_tasks:
        return Plan(made_from="nothing")
    situation = situation_of(replace(known, open_tasks=known.possible_tasks))
    rounds = rounds_for(situation.problem, old is not None)
    if is_brief:
        rounds = rounds._replace(crews=rounds.crews // BRIEF, team=rounds.team // BRIEF)
    old_plan: _Entered | None = None
    if old is not None:
        old_plan = _Entered("old plan", _search_from(situation, kept_plan(situation, old)))
    kept = None if old_plan is None else shared_plan_of(situation, old_plan.search, "kept")
    kept_cost = 0 if old_plan is None else old_plan.search.cost
    chosen, search = _search(situation, rounds, known.step, old_plan, is_brief)
    best = shared_plan_of(situation, search, chosen)
    if kept is not None and old_plan is not None:
        if has_prices(situation.problem):
            gain = kept_cost // SMALLEST_GAIN
            return kept if search.cost + gain >= kept_cost else best
        left = kept.makespan - known.step
        if best.makespan + left // SMALLEST_GAIN >= kept.makespan:
            return kept
    return best


class _Entered(NamedTuple):
    """A search that takes part in the race, and what it began with."""

    name: str
    search: ThresholdSearch

    def steps_left(self, step: int) -> int:
        """Return how many steps its best plan takes from a step on."""
        return self.search.makespan - step


def _cost_of(entered: _Entered) -> int:
    return entered.search.cost


def _run(entered: list[_Entered], rounds: int) -> None:
    for _, search in entered:
        search.run(rounds, HOT)


def _race(entered: list[_Entered], rounds: Rounds) -> _Entered:
    """Let the best searches go on, fewer and fewer of them, and return the best."""
    for number, part in LAPS:
        entered = sorted(entered, key=_cost_of)[:number]
        _run(entered, rounds.team // part)
    return min(entered, key=_cost_of)


def _search(
    situation: Situation, rounds: Rounds, step: int, old: _Entered | None, is_brief: bool
) -> _Entered:
    """Return the best search from all starts, which race; of a large mission only if crews lead."""
    fresh = list(_first_searches(situation, rounds, step, old))
    entered = fresh if old is None else [old, *fresh]
    if has_prices(situation.problem):
        entered += [_by_due(situation, entry) for entry in entered]
    first = min(entered, key=_cost_of)
    if is_large(situation) and first.name != CREWS:
        return first
    _run(entered, rounds.team // FIRST_LAP)
    if not is_brief:
        more = list(_more_searches(situation, rounds, _are_crews_better(fresh, step)))
        _run(more, rounds.team // FIRST_LAP)
        entered = [*entered, *more]
    return _race(entered, rounds)


def _first_searches(
    situation: Situation, rounds: Rounds, step: int, old: _Entered | None
) -> Iterator[_Entered]:
    """Return a search from a plan of each kind; from crews only if there is hope.

    In a large mission there may be no hope for coalitions either, as a brief search tells.
    """
    crews = plan_from_crews(situation.problem, situation.company, rounds.crews)
    entered = _Entered(CREWS, _search_from(situation, crews))
    if is_large(situation):
        brief = rounds._replace(coalition=rounds.coalition // GLANCE)
        other = _enter_coalitions(situation, brief, old=old)
        if other is None or _is_hopeless(other, entered, step):
            yield entered
            return
    other = _enter_coalitions(situation, rounds, old=old)
    if other is None:
        yield entered
        return
    if has_prices(situation.problem) or not _is_hopeless(entered, other, step):
        yield entered
    yield other


def is_large(situation: Situation) -> bool:
    """Say whether a mission is searched over graphs of arcs, which know the makespan alone."""
    return len(situation.tasks) >= LARGE and not has_prices(situation.problem)


def _by_due(situation: Situation, entry: _Entered) -> _Entered:
    """Return a search from a plan whose tasks come in the order in which they are due."""
    return _Entered(entry.name, _search_from(situation, by_due(situation, entry.search.best)))


def _is_hopeless(entered: _Entered, other: _Entered, step: int) -> bool:
    """Say whether a search begins so far behind another that nobody need run it."""
    return entered.steps_left(step) > other.steps_left(step) * (HOPELESS + 1) // HOPELESS


def _enter_coalitions(
    situation: Situation, rounds: Rounds, seed: int = 0, old: _Entered | None = None
) -> _Entered | None:
    """Return a search from coalitions; None if none were found."""
    found = _find_coalitions(situation, rounds, seed, old)
    return None if found is None else _Entered(COALITIONS, _search_from(situation, found))


def _find_coalitions(
    situation: Situation, rounds: Rounds, seed: int, old: _Entered | None
) -> TeamPlan | None:
    """Return a plan from one search for coalitions; of a large mission beginning at the old one."""
    if not is_large(situation):
        return plan_from_coalitions(situation.problem, rounds.coalition, seed)
    start = None if old is None else old.search.best
    return plan_from_arcs(situation, rounds.coalition, seed, start)


def _are_crews_better(fresh: list[_Entered], step: int) -> bool:
    """Say whether crews are clearly better than coalitions, or there are no coalitions."""
    left = {entered.name: entered.steps_left(step) for entered in fresh}
    if len(left) == 1:
        return CREWS in left
    return left[COALITIONS] > left[CREWS] + left[CREWS] // CLEARLY


def _more_searches(
    situation: Situation, rounds: Rounds, crews_are_better: bool
) -> Iterator[_Entered]:
    """Return searches from more plans of the better kind: several find more than a long one."""
    if crews_are_better:
        for longer in CREW_SEARCHES:
            tries = rounds.crews * longer // 10
            crews = plan_from_crews(situation.problem, situation.company, tries)
            yield _Entered(CREWS, _search_from(situation, crews))
    else:
        for seed in range(1, rounds.coalitions):
            entered = _enter_coalitions(situation, rounds, seed)
            if entered is not None:
                yield entered


def _search_from(situation: Situation, start: TeamPlan) -> ThresholdSearch:
    search = ThresholdSearch(
        situation.problem, situation.crossings, situation.company, situation.forming_steps
    )
    search.begin(start)
    return search


def kept_plan(situation: Situation, old: Plan) -> TeamPlan:
    """Return what is left of an old plan, with new tasks at its end."""
    return complete_plan(situation.problem, *plan_in_numbers(situation, old))


def by_due(situation: Situation, plan: TeamPlan) -> TeamPlan:
    """Return a plan with its tasks in the order in which they are due; the mission has prices."""
    due = situation.problem.prices.due
    order = plan.order[np.argsort(due[plan.order], kind="stable")]
    return plan._replace(order=order)


def timed_plan(situation: Situation, plan: TeamPlan, start: str) -> tuple[int, Plan]:
    """Return what a plan costs, which is its makespan if that alone counts; and the plan.

    It is in the numbers of the mission, with the steps in which its tasks are done.
    """
    search = _search_from(situation, plan)
    cost = search.cost if has_prices(situation.problem) else search.makespan
    return cost, shared_plan_of(situation, search, start)


def plan_in_numbers(situation: Situation, plan: Plan) -> tuple[list[int], list[list[int]]]:
    """Return order and coalitions, by task, in the numbers of a situation; new tasks come last."""
    number = {robot: index for index, robot in enumerate(situation.robots)}
    place = {task: index for index, task in enumerate(situation.tasks)}
    order = [place[task] for task in plan.order if task in place]
    coalitions: list[list[int]] = [[] for _ in situation.tasks]
    for task, robots in zip(plan.order, plan.coalitions, strict=True):
        if task in place:
            coalitions[place[task]] = [number[robot] for robot in robots if robot in number]
    return order + sorted(set(range(len(coalitions))) - set(order)), coalitions


def shared_plan_of(situation: Situation, search: ThresholdSearch, start: str) -> Plan:
    """Return what a search found in the numbers of the mission."""
    ends = tuple(int(search.ends[task]) for task in search.best.order)
    return replace(plan_of(situation, search.best), ends=ends, made_from=start)
