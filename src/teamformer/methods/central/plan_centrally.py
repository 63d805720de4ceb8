"""What the central planner makes of one mission: plans, their plays, and the best of these."""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial
from itertools import chain

import numpy as np

from teamformer.methods.central.plan_from_play import CoalitionLog, plan_from_play
from teamformer.methods.central.players import Player
from teamformer.methods.central.plays import CentralPlan, Plays
from teamformer.methods.central.variations import vary
from teamformer.methods.coordinators.crews import Crews
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.methods.scripted.joining import JoinAll
from teamformer.mission.checks.optional import has_optional
from teamformer.mission.coordination import Plan
from teamformer.mission.model import Mission
from teamformer.planning.bounds.earliest import earliest_starts
from teamformer.planning.bounds.makespan import lower_bound
from teamformer.planning.bounds.route_cover import raise_by_routes
from teamformer.planning.bounds.start_windows import raise_by_windows
from teamformer.planning.problem.coalition_plan import (
    CoalitionPlan,
    keep_order,
    plan_of_lists,
)
from teamformer.planning.problem.relaxed_problem import Relaxed, relax
from teamformer.planning.race import Race
from teamformer.planning.relaxation.solve import RelaxedSolution, solve
from teamformer.planning.steps.shared_plan import is_too_large
from teamformer.planning.steps.situation import Situation, situation_in_hindsight
from teamformer.planning.steps.solve import (
    begin_race,
    first_plan,
    from_best,
    from_coalitions,
    improve,
)
from teamformer.planning.steps.timed_plan import TimedPlan, time_team_plan
from teamformer.world.rules.constants import FAR

SEARCHES = 5
"""How many plans are searched for and played, each from another seed, while there is time."""

VARYING = 0.5
"""Share of the time that is left to changes of the best plan if a search ends early."""

RELAXING = 0.3
"""Share of the time for the relaxed schedule and its proof, on one thread."""

BOUNDING = 0.2
"""Share of the time for bounds by routes and by windows, on the other."""

AT_ONCE = 5e7
"""What a bound may look at in one go for each second that it has: a tenth of them."""

CREW_SECONDS = 6e-6
"""What planning crews may take, for each task times robots and tasks: twice what it does take.

It is not begun with less time left, as it cannot be stopped.
"""

FEW_CAPABILITIES = 8
"""With more, planning crews takes longer in proportion."""

FOLLOWED: tuple[tuple[str, Player], ...] = (("crews", Crews()), ("join-all", JoinAll()))
"""Names of what is played for the search to begin at, and who plays it."""


def plan_centrally(
    mission: Mission,
    time_limit: float,
    seed: int = 0,
    workers: int = 2,
    believed: Mission | None = None,
    start: Plan | None = None,
) -> CentralPlan:
    """Return the best plan found in `time_limit` seconds; the first one if that is 0.

    The default and simple rules are played too, so that the plan is never slower than theirs: the
    shared plan, or crews where that would take too long, with what the mission says and, in an
    uncertain mission, as by robots that know only what is `believed`. So is a `start`, a plan of
    all tasks, and the search may begin with it.
    """
    plays = Plays(mission, time.perf_counter(), time_limit)
    shared = CoalitionLog(mission)
    name, default = ("crews", Crews()) if is_too_large(mission) else ("plan", SharedPlan())
    plays.add(name, default, log=shared)  # the first play is never cut short
    if believed is not None and believed.has_surprises:
        plays.add_as_believed(name, default, believed)
    given = None if start is None else _team_plan(start, len(mission.tasks))
    if given is not None:
        plays.add_plan("start", given)
    situation = situation_in_hindsight(mission)
    first = _first_plan(mission, situation)
    if first is not None:
        plays.add_plan("search", first.plan)
    plays.add_simple_rules()
    if first is None or time_limit == 0:
        solution = solve(mission, plays.seconds_left, seed=seed)
        bound, searched = solution.bound, list[tuple[float, int]]()
    else:
        race = begin_race(first, plays.begun, plays.begun + plays.limit)
        for played in (shared.plan(), given):
            if played is not None:
                race.offer(time_team_plan(situation, played))
        for name, followed in FOLLOWED:
            _follow(name, mission, followed, situation, race, plays)
        solution, bound, searched = _search(mission, situation, race.plan, plays, seed, workers)
    if time_limit > 0 and solution.plan is not None:
        order = keep_order(situation.problem.before, solution.plan.order.tolist())
        plays.add_plan("schedule", solution.plan._replace(order=np.array(order, np.int32)))
    if time_limit > 0:
        vary(situation.problem, plays, bound, seed)
    if has_optional(mission):  # the others count all tasks
        bound = lower_bound(mission)
    return plays.report(solution, bound, searched, is_first=time_limit == 0)


def _first_plan(mission: Mission, situation: Situation) -> TimedPlan | None:
    """Return a first plan; None if some task can never be done."""
    if (earliest_starts(relax(mission)) >= FAR).any():
        return None
    return first_plan(situation)


def _follow(
    name: str,
    mission: Mission,
    followed: Player,
    situation: Situation,
    race: Race[TimedPlan],
    plays: Plays,
) -> None:
    """Offer what a player does as a plan to begin at; leave it if time is short."""
    tasks, kinds = len(mission.tasks), max(1.0, len(mission.capabilities) / FEW_CAPABILITIES)
    if plays.seconds_left < CREW_SECONDS * kinds * tasks * (tasks + len(mission.robots)):
        return
    plan = plan_from_play(mission, followed, plays.begun + plays.limit)
    if plan is not None:
        race.offer(time_team_plan(situation, plan))
        plays.add_plan(name, plan)


def _search(
    mission: Mission,
    situation: Situation,
    first: TimedPlan,
    plays: Plays,
    seed: int,
    workers: int,
) -> tuple[RelaxedSolution, int, list[tuple[float, int]]]:
    """Search and play what is found; return the relaxed solution, the bound and a curve.

    A plan may promise what no plan beats, on planes above all, and its play not keep that; and
    searches in small worlds end early. Then it is searched again from another seed.
    """
    solution, race = _improve(mission, situation, first, plays, seed, workers)
    plays.add_plan("search", race.plan.plan)
    bound, curve = race.bound, race.curve
    for number in range(1, SEARCHES):
        if plays.is_proven(bound) or plays.seconds_left <= VARYING * plays.limit:
            break
        _, race = _improve(mission, situation, first, plays, seed + number, workers)
        plays.add_plan("search", race.plan.plan)
        bound, curve = max(bound, race.bound), curve + race.curve
    return solution, bound, curve


def _improve(
    mission: Mission,
    situation: Situation,
    first: TimedPlan,
    plays: Plays,
    seed: int,
    workers: int,
) -> tuple[RelaxedSolution, Race[TimedPlan]]:
    """Search until it is time for the last plays, from coalitions on one thread.

    The other proves a bound and then searches on from the best plan.
    """
    race = begin_race(first, plays.begun, time.perf_counter() + plays.seconds_left)
    jobs: list[Callable[[], RelaxedSolution | None]] = [
        partial(_raise_bound, mission, relax(mission), race),
        partial(_relax_and_search, mission, situation, race, seed),
    ]
    if workers > 1:  # begins when the bound is through
        jobs.append(partial(improve, race, situation, from_best(race), seed))
    _, solution, *_ = race.run(jobs, min(workers, 2))
    return solution, race


def _raise_bound(mission: Mission, problem: Relaxed, race: Race[TimedPlan]) -> None:
    """Prove what can be proven in a share of the time."""
    begun, seconds = time.perf_counter(), BOUNDING * race.seconds_left

    def is_over() -> bool:
        return race.is_over or time.perf_counter() - begun >= seconds

    race.raise_bound(lower_bound(mission))
    largest = AT_ONCE * seconds
    bound = raise_by_routes(mission, problem, race.bound, race.raise_bound, is_over, largest)
    raise_by_windows(mission, problem, bound, race.raise_bound, is_over)


def _relax_and_search(
    mission: Mission, situation: Situation, race: Race[TimedPlan], seed: int
) -> RelaxedSolution:
    """Solve the relaxed problem, then search from its coalitions and from others."""
    seconds = RELAXING * race.seconds_left
    solution = solve(mission, seconds, seed=seed, is_stopped=race.is_stopped)
    race.raise_bound(solution.bound)
    starts = from_coalitions(situation.problem, race, seed)
    if solution.plan is not None:
        starts = chain([solution.plan], starts)
    improve(race, situation, starts, seed + 1)
    return solution


def _team_plan(plan: Plan, tasks: int) -> CoalitionPlan:
    coalition_of = dict(zip(plan.order, plan.coalitions, strict=True))
    left_out = [task for task in range(tasks) if task not in coalition_of]
    coalitions = [coalition_of.get(task, ()) for task in range(tasks)]
    return plan_of_lists([*plan.order, *left_out], coalitions)
