"""How much better than the planner's a plan of a tiny mission can be, of all that there are.

`PYTHONPATH=tests python tests/fuzz/tiny.py continuous 2000 1` draws so many missions in continuous
time, and gives `central` a second for each; with 0 seconds the default plans. `steps` draws
missions in steps, `optional` such with optional tasks, of which every plan leaves out others,
`zones` such with zones, which every plan enters in its order, `docks` such with loads at zones, and
`charging` such with batteries.
"""

from __future__ import annotations

import itertools
import math
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from hypothesis import HealthCheck, given, seed, settings

from missions import continuous_missions, missions
from plain_times import Times, Ways, able_crews, all_plans
from random_worlds import (
    random_world,
    with_batteries,
    with_docks,
    with_loads,
    with_optional,
    with_zones,
)
from teamformer.base.errors import MissionError, TeamformerError
from teamformer.files.mission_files import mission_from_tree
from teamformer.methods.by_name import Player
from teamformer.methods.central.plays import Plays, price_of_missed
from teamformer.methods.central.policy import Central
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.mission.checks.costs import judged_by, weighed
from teamformer.mission.model import Mission
from teamformer.mission.parts.zones import has_loads_at_zones, rooms_of
from teamformer.planning.continuous.continuous_mission import pose_mission
from teamformer.planning.continuous.rules import plan_continuous, warm_up
from teamformer.planning.problem.coalition_plan import CoalitionPlan, plan_of_lists
from teamformer.planning.problem.routes import MissionPlan
from teamformer.record.record import Record
from teamformer.record.task_times import done_steps, missed_tasks
from teamformer.trials.trial import run_trial
from texts import text_of

MOST_PLANS, MOST_PLANS_IN_STEPS = 30_000, 3_000
"""Missions with more plans than this are passed over: nobody waits until all are timed."""

ROBOTS, TASKS = 4, 4
"""How many a mission has at most."""

NEAR = 1e-5
"""Times are told in whole ticks, of which there are a million and more in all."""


def count_plans(mission: Mission) -> int:
    """Return how many orders with coalitions a mission has."""
    able = (len(_crews(mission, task)) for task in range(len(mission.tasks)))
    return math.factorial(len(mission.tasks)) * math.prod(able)


def worth_of(mission: Mission, made: MissionPlan | Times) -> float:
    """Return what a plan is judged by: its cost, or the makespan and twice how late tasks are."""
    if made.cost is not None:
        return made.cost
    return made.makespan + 2 * sum(
        mission.tasks[task].weight * by for task, by in made.late.items()
    )


def gap_in_continuous_time(mission: Mission, method: str, seconds: float) -> float:
    """Return by which share of the best plan a method's is worse; 0 where it finds none."""
    try:
        made = plan_continuous(pose_mission(mission), method, seconds)
    except TeamformerError:
        return 0.0
    if made is None:
        return 0.0
    best = min(worth_of(mission, plan) for plan in all_plans(mission, Ways(mission)))
    gap = worth_of(mission, made) - best
    return gap / max(best, NEAR) if gap > NEAR * max(1.0, best) else 0.0


def gap_in_steps(mission: Mission, seconds: float, method: Player | None = None) -> float:
    """Return by which share of the best play of a plan that of a method, `central`, is worse.

    Every plan is played by the rules. 1 stands for a mission that only another plan completes.
    """
    player = method or Central(seconds, workers=1)
    made = played_worth(run_trial(mission, player, seed=0).record)
    plays = Plays(mission, time.perf_counter(), math.inf)
    best = min(plays.add_plan("", plan)[0] for plan in _all_team_plans(mission))
    if made <= best + NEAR * max(1.0, best):
        return 0.0
    return 1.0 if made == math.inf else (made - best) / max(best, NEAR)


def played_worth(record: Record) -> float:
    """Return what a mission was judged by: its makespan, or what it costs; infinity if not done."""
    mission, makespan = record.true_mission, record.end.makespan
    weights, missed = judged_by(mission), price_of_missed(mission, missed_tasks(record))
    if weights is None or makespan is None:
        return math.inf if makespan is None else missed + makespan
    return missed + weighed(mission, weights, done_steps(record), makespan)


def _all_team_plans(mission: Mission) -> Iterator[CoalitionPlan]:
    tasks = range(len(mission.tasks))
    for crews in itertools.product(*(_crews(mission, task) for task in tasks)):
        for order in itertools.permutations(tasks):
            yield plan_of_lists(order, crews)


def _crews(mission: Mission, task: int) -> list[tuple[int, ...]]:
    """Return the coalitions that can do a task, and nobody if it may be left out."""
    nobody: list[tuple[int, ...]] = [()] if mission.tasks[task].optional else []
    return [*nobody, *able_crews(mission, task)]


def _draw_tiny(
    number: int,
    make: Callable[[np.random.Generator], Mission],
    is_it: Callable[[Mission], bool],
) -> Mission:
    """Draw missions until one is tiny and is what is wanted."""
    rng = np.random.default_rng(number)
    while True:
        try:
            mission = make(rng)
        except MissionError:  # there is no charger in some part of the map
            continue
        is_tiny = len(mission.robots) <= ROBOTS and 1 < len(mission.tasks) <= TASKS
        if is_tiny and is_it(mission):
            return mission


def _with_durations(rng: np.random.Generator) -> Mission:
    """Draw a mission in which tasks take some steps."""
    mission = random_world(rng, False, False)
    tasks = tuple(replace(task, duration=int(rng.integers(1, 9))) for task in mission.tasks)
    return replace(mission, tasks=tasks, step_limit=0)


def draw_optional(number: int) -> Mission:
    """Draw a tiny mission in steps with optional tasks."""
    return _draw_tiny(
        number,
        lambda rng: with_optional(random_world(rng, False, False), rng),
        lambda mission: any(task.optional for task in mission.tasks),
    )


def draw_zones(number: int) -> Mission:
    """Draw a tiny mission in steps with zones, in which tasks take some steps."""
    return _draw_tiny(
        number,
        lambda rng: with_zones(_with_durations(rng), rng),
        lambda mission: bool(rooms_of(mission)),
    )


def draw_docks(number: int) -> Mission:
    """Draw a tiny mission in steps with loads that are taken up or unloaded in zones."""
    return _draw_tiny(
        number,
        lambda rng: with_docks(with_loads(_with_durations(rng), rng), rng),
        has_loads_at_zones,
    )


def draw_charging(number: int) -> Mission:
    """Draw a tiny mission in steps with batteries."""
    return _draw_tiny(
        number,
        lambda rng: with_batteries(random_world(rng, False, False), rng),
        lambda mission: mission.charging is not None,
    )


DRAWN_IN_STEPS = {
    "optional": draw_optional,
    "zones": draw_zones,
    "docks": draw_docks,
    "charging": draw_charging,
}


def main(kind: str, count: int, seconds: float) -> int:
    """Try so many missions; print those of which a better plan is found."""
    tried, worse = set[str](), list[float]()
    is_continuous = kind == "continuous"
    most = MOST_PLANS if is_continuous else MOST_PLANS_IN_STEPS

    def check(mission: Any) -> None:
        check_it(mission_from_tree(mission), text_of(mission))

    def check_it(source: Mission, text: str) -> None:
        if text in tried or not 1 < count_plans(source) <= most:
            return
        tried.add(text)
        if is_continuous:
            warm_up(source)
            gap = gap_in_continuous_time(source, "central" if seconds else "plan", seconds)
        else:
            gap = gap_in_steps(source, seconds, None if seconds else SharedPlan())
        if gap > 0:
            worse.append(gap)
            print(f"# {gap:.2%} worse, number {len(tried)}\n{text}", flush=True)

    drawn = (
        continuous_missions(ROBOTS, TASKS)
        if is_continuous
        else missions(is_sure=True, has_cancelled=False)
    )
    for number in itertools.count():
        if len(tried) >= count:
            break
        if kind in DRAWN_IN_STEPS:
            check_it(DRAWN_IN_STEPS[kind](number), f"number {number}")
            continue
        checks = settings(
            max_examples=50,
            deadline=None,
            database=None,
            suppress_health_check=list(HealthCheck),
        )
        seed(number)(checks(given(mission=drawn)(check)))()
    found = f"{len(worse)} of {len(tried)} tiny missions have a better plan"
    print(f"{found}, by up to {max(worse, default=0.0):.2%}")
    return int(bool(worse))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], int(sys.argv[2]), float(sys.argv[3])))
