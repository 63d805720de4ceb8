"""The plan that every robot works out alike: who does which task with whom, in what order.

It is a pure function of what everybody knows: no clock, a fixed number of rounds, a fixed seed,
whole numbers. So all robots, on any processor, find the same plan.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from typing import NamedTuple

from teamformer.mission.coordination import Known, Plan
from teamformer.mission.model import Mission
from teamformer.planning.problem.coalition_plan import CoalitionPlan, without_riders
from teamformer.planning.problem.relaxed_problem import Relaxed, has_prices, most_in_coalitions
from teamformer.planning.steps.arc_search import LARGE, TeamArcs
from teamformer.planning.steps.situation import Situation, plan_of, situation_of
from teamformer.planning.steps.starts import complete_plan, plan_from_coalitions, plan_from_crews
from teamformer.planning.steps.timed_plan import TimedPlan, time_team_plan

CREWS, COALITIONS, ANEW = "crews", "coalitions", "arcs"
"""What a plan is made from: what crews do, coalitions that are best where joining is free, or
nothing."""

HOPELESS = 4
"""A start is not searched from at all if it takes a quarter longer than another."""

GLANCE = 20
"""A brief search from an empty plan is so much shorter."""

OLD, KEPT = "old plan", "kept"
"""What is made from the old plan, and the old plan itself."""

MORE, MORE_IF_PRICED = 3, 10
"""All starts together have the rounds of so many more."""

MOST_AT_ONCE = 10_000_000
"""A mission with more tasks times tasks and robots is too large to be planned while one waits."""

SMALLEST_GAIN = 50
"""The part of the steps left that a new plan must gain for anybody to turn round: a fiftieth."""

ARC_ROUNDS, ROUNDS_TIMES_TASKS = 900_000, 210_000_000
"""Rounds over graphs of arcs; what is made of these times tasks at most, as rounds take longer."""

ROUNDS_A_START, ROUNDS_A_PAIR = 30_000, 300
"""Rounds from each start at most, and for each pair of tasks."""

WIDE = 10
"""Robots of a coalition; where these are more on average, rounds take longer, by their square."""

STARTS, STARTS_WITH_LOADS = 6, 24
"""How many coalitions are searched from; more at the start of a mission with loads, where one
search ends far from another."""

BRIEF = 4
"""A brief search is so much shorter, and begins with one plan of each kind."""


class Rounds(NamedTuple):
    """How long to search: for lists of crews, for coalitions each time, over graphs of arcs.

    `arcs` is for each start on average, or in a large mission in all; `coalitions` is how many
    starts are coalitions.
    """

    crews: int
    coalition: int
    arcs: int
    coalitions: int


def rounds_for(problem: Relaxed, is_again: bool) -> Rounds:
    """Return the rounds for a mission of a size: fixed, as a clock would not be the same for all.

    About a second of one core for 16 robots and 60 tasks, less than half of that when planned
    again; some three seconds for 100 robots and 300 tasks.
    """
    tasks = len(problem.appears)
    crews, coalition = 1500 * tasks, relaxed_rounds(problem)
    is_large = tasks >= LARGE and not has_prices(problem)
    if is_large:
        arcs, coalitions = min(ARC_ROUNDS, ROUNDS_TIMES_TASKS // tasks), 0
    else:
        arcs = min(ROUNDS_A_START, ROUNDS_A_PAIR * tasks * tasks)
        coalitions = STARTS_WITH_LOADS if problem.carry.any() and not is_again else STARTS
    robots = max(WIDE, int(most_in_coalitions(problem).sum()) // tasks)
    arcs = arcs * WIDE**2 // robots**2
    if is_again:
        return Rounds(crews // 5, 1 + coalition // 5, arcs // (5 if is_large else 3), coalitions)
    return Rounds(crews, coalition, arcs, coalitions)


def relaxed_rounds(problem: Relaxed) -> int:
    """Return how long coalitions are searched for with forming not counted."""
    tasks, needs = len(problem.appears), int(most_in_coalitions(problem).sum())
    return min(3 * tasks * tasks // 2, 130_000 // (tasks + 10 * needs // tasks))


def is_too_large(mission: Mission) -> bool:
    """Say whether a shared plan would take too long to wait for; crews are planned sooner."""
    tasks = len(mission.tasks)
    return tasks * (tasks + len(mission.robots)) > MOST_AT_ONCE


def plan_mission(
    known: Known,
    old: Plan | None = None,
    is_brief: bool = False,
    choose: Callable[[Known, Iterator[Plan]], Plan] | None = None,
) -> Plan:
    """Return the plan from the present on; never worse by its own count than the old one.

    Robots that will be lost or back and tasks that have not appeared play no part; what the robots
    that are left cannot do is not in the plan. `is_brief` is for those who plan again often: fewer
    searches, and shorter ones. At the start another rule than the count may `choose` among good
    plans, the best of which by that count comes first.
    """
    if not known.possible_tasks:
        return Plan(made_from="nothing")
    situation = situation_of(replace(known, open_tasks=known.possible_tasks))
    rounds = rounds_for(situation.problem, old is not None)
    if is_brief:
        rounds = Rounds(rounds.crews // BRIEF, rounds.coalition, rounds.arcs // BRIEF, 1)
    if old is None:
        seen: list[Named] = []
        best_found = search(situation, rounds, known.step, seen=seen)
        if choose is not None:
            named = (best_found, *sorted(seen, key=_rank_of))
            return choose(known, (shared_plan_of(situation, *it) for it in named))
        return shared_plan_of(situation, *best_found)
    kept = time_team_plan(situation, kept_plan(situation, old))
    name, best = search(situation, rounds, known.step, kept)
    is_better = best.makespan + (kept.makespan - known.step) // SMALLEST_GAIN < kept.makespan
    if best.missed != kept.missed:
        is_better = best.cost < kept.cost
    elif kept.has_prices:
        is_better = best.cost + kept.cost // SMALLEST_GAIN < kept.cost
    return shared_plan_of(situation, name if is_better else KEPT, best if is_better else kept)


Named = tuple[str, TimedPlan]
"""A plan, and what it was made from."""


def search(
    situation: Situation,
    rounds: Rounds,
    step: int,
    old: TimedPlan | None = None,
    seen: list[Named] | None = None,
) -> Named:
    """Return the best plan found, and what it was made from.

    `step` is the present, and `old` what is left of a plan from before. Other good plans of a
    mission that is not large are put into `seen`.
    """
    arcs = TeamArcs(situation)
    priced = has_prices(situation.problem)
    if len(situation.tasks) >= LARGE and not priced:
        return _search_once(arcs, rounds, step, old)
    plans = list(_starts(situation, rounds))
    if old is not None:
        plans.append((OLD, old))
    if not priced:
        plans = _hopeful(plans, step)
    more = MORE_IF_PRICED if priced else MORE
    kept = [] if seen is None else seen
    name, best = _by_halving(arcs, plans, rounds.arcs * (len(plans) + more), kept)
    problem = situation.problem
    timed = partial(time_team_plan, situation)
    return name, without_riders(problem.counts, problem.needs, best, timed, is_strict=True)


def _by_halving(arcs: TeamArcs, plans: list[Named], rounds: int, seen: list[Named]) -> Named:
    """Improve plans by successive halving (Karnin, Koren and Somekh 2013); return the best one.

    The rounds are cut into equal parts. All plans share the first part, the better half of them
    shares the next part, and so on; the last plan that is left has the last part for itself. All
    that come by are put into `seen`.
    """
    parts = 1 + (len(plans) - 1).bit_length()
    while True:
        share = rounds // parts // len(plans)
        plans = [(name, arcs.improve(plan, share)) for name, plan in plans]
        seen += plans
        if len(plans) == 1:
            return plans[0]
        plans = sorted(plans, key=_lead_of)[: (len(plans) + 1) // 2]


def _starts(situation: Situation, rounds: Rounds) -> Iterator[Named]:
    """Return a plan from crews, and plans from coalitions."""
    yield CREWS, _plan_crews(situation, rounds)
    for seed in range(rounds.coalitions):
        found = plan_from_coalitions(situation.problem, rounds.coalition, seed)
        if found is not None:
            yield COALITIONS, time_team_plan(situation, found)


def _plan_crews(situation: Situation, rounds: Rounds) -> TimedPlan:
    crews = plan_from_crews(situation.problem, situation.company, rounds.crews)
    return time_team_plan(situation, crews)


def _search_once(arcs: TeamArcs, rounds: Rounds, step: int, old: TimedPlan | None) -> Named:
    """Plan a large mission: from the old plan, from an empty one, or as crews if these lead.

    A brief search tells whether there is hope for anything but crews.
    """
    crews = (CREWS, _plan_crews(arcs.situation, rounds))
    plans = [crews]
    if old is not None:
        plans.append((OLD, arcs.improve(old, rounds.arcs)))
    else:
        glance = arcs.plan_anew(rounds.arcs // GLANCE)
        if glance is not None and len(_hopeful([(ANEW, glance), crews], step)) == 2:
            found = arcs.plan_anew(rounds.arcs)
            assert found is not None, "it was found before"
            plans.append((ANEW, found))
    best = min(plans, key=_rank_of)
    return (CREWS, arcs.improve(crews[1], rounds.arcs)) if best is crews else best


def _hopeful(plans: list[Named], step: int) -> list[Named]:
    """Return the plans that do not take much longer than the best, from a step on.

    All are where tasks can be missed.
    """
    if any(plan.missed is not None for _, plan in plans):
        return plans
    least = min(plan.makespan for _, plan in plans) - step
    return [
        (name, plan)
        for name, plan in plans
        if plan.makespan - step <= least * (HOPELESS + 1) // HOPELESS
    ]


def _rank_of(named: Named) -> tuple[int, int]:
    return named[1].rank


def _lead_of(named: Named) -> int:
    return named[1].lead


def kept_plan(situation: Situation, old: Plan) -> CoalitionPlan:
    """Return what is left of an old plan, with new tasks at its end."""
    return complete_plan(situation.problem, *plan_in_numbers(situation, old))


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


def shared_plan_of(situation: Situation, start: str, timed: TimedPlan) -> Plan:
    """Return what a search found in the numbers of the mission, and what it was made from."""
    plan = timed.plan
    ends = tuple(int(timed.ends[task]) for task in plan.order if plan.size[task] > 0)
    return replace(plan_of(situation, timed.plan), ends=ends, made_from=start)
