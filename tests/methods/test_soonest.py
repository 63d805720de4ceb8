"""The rules without search: what `soonest` plans, by hand, and that they end."""

from __future__ import annotations

import pytest

from teamformer.files.drawn.named_settings import world_of
from teamformer.methods.coordinators.reactive import Reactive
from teamformer.methods.coordinators.soonest import Soonest
from teamformer.mission.coordination import Coordinator, Known
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.trials.trial import run_trial


def at_the_start(mission: Mission) -> Known:
    robots = range(len(mission.robots))
    return Known(
        mission=mission,
        now=0,
        open_tasks=tuple(range(len(mission.tasks))),
        places=tuple(robot.at for robot in mission.robots),
        teams=tuple((robot,) for robot in robots),
        free_at=(0,) * len(robots),
    )


def test_the_task_that_can_begin_soonest_comes_next() -> None:
    """Two lifters at 0 and 9, a welder at 4.

    Somebody is at `near` (2) after 2 steps, at `joint` (6) after 3 (the welder after 2, the right
    lifter after 3), at `far` (8) after 1. So `far` comes first, by the right lifter, who is then
    at `joint` in 3, and there in all: 1 + 2 = 3. `near` begins after 2 steps and comes before it.
    """
    mission = Mission(
        "line",
        Grid(10, 1),
        ("lift", "weld"),
        (
            Robot("left", (0, 0), {"lift": 1}),
            Robot("right", (9, 0), {"lift": 1}),
            Robot("welder", (4, 0), {"weld": 1}),
        ),
        (
            Task("joint", (6, 0), {"lift": 1, "weld": 1}),
            Task("near", (2, 0), {"lift": 1}),
            Task("far", (8, 0), {"lift": 1}),
        ),
    )
    plan = Soonest().update(at_the_start(mission), None)
    assert plan.order == (2, 1, 0)
    assert plan.coalitions == ((1,), (0,), (1, 2))


def test_what_comes_after_others_waits_for_them_and_nobody_is_spare() -> None:
    """`second` is near, but comes after `first`; two robots bring enough, the third stays out."""
    robots = [
        Robot(name, (x, 0), {"lift": n}) for name, x, n in (("a", 0, 1), ("b", 1, 2), ("c", 2, 2))
    ]
    mission = Mission(
        "after",
        Grid(10, 1),
        ("lift",),
        tuple(robots),
        (
            Task("second", (0, 0), {"lift": 1}, after=("first",)),
            Task("first", (3, 0), {"lift": 4}),
        ),
    )
    plan = Soonest().update(at_the_start(mission), None)
    assert plan.order == (1, 0)
    assert plan.coalitions[0] == (1, 2)


@pytest.mark.parametrize("rule", [Soonest(), Reactive()])
@pytest.mark.parametrize("setting", ["real-all", "warehouse-lost", "carry", "air-ground"])
def test_they_end_whatever_happens(setting: str, rule: Coordinator) -> None:
    for seed in range(2):
        trial = run_trial(world_of(setting, 2000 + seed), rule, seed)
        assert trial.record.end.status == "completed"


def test_the_best_of_many_futures_is_better_than_the_rule() -> None:
    worlds = [world_of(setting, 3000) for setting in ("real", "sparse")]
    steps = [
        sum(run_trial(world, rule, 0).record.end.steps for world in worlds)
        for rule in (Reactive(), Soonest())
    ]
    assert steps[0] < 0.9 * steps[1]


def test_it_chooses_better_than_the_papers_order() -> None:
    """Worlds of other seeds than those by which the rule was chosen."""
    from teamformer.methods.scripted.heuristic import Heuristic

    worlds = [world_of("real", 3000 + seed) for seed in range(3)]
    ours = sum(run_trial(world, Soonest(), 0).record.end.steps for world in worlds)
    papers = sum(run_trial(world, Heuristic(), 0).record.end.steps for world in worlds)
    assert ours < 0.8 * papers
