"""Plans of missions in steps with zones: by hand, and undisturbed they take what they say."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from random_worlds import with_zones
from small_worlds import make, robot, task
from teamformer.files.drawn.generate import Spec, generate
from teamformer.files.drawn.named_settings import world_of
from teamformer.methods.by_name import load_method
from teamformer.mission.coordination import Known, known_at_start
from teamformer.mission.model import Mission
from teamformer.mission.parts.zones import Zone
from teamformer.planning.problem.coalition_plan import plan_of_lists
from teamformer.planning.steps.shared_plan import plan_mission
from teamformer.planning.steps.situation import situation_of
from teamformer.planning.steps.timed_plan import time_team_plan
from teamformer.record.referee.judge import judge
from teamformer.record.task_times import done_steps
from teamformer.trials.trial import run_trial


def three(room: int) -> Mission:
    """Return robots at 1, 3 and 7 and tasks of 3 steps at 2, 5 and 9, with room for so many."""
    mission = make(
        [robot("a", x) for x in (1, 3, 7)], [task("a", x, duration=3) for x in (2, 5, 9)]
    )
    zone = Zone("dock", tasks=tuple(task.name for task in mission.tasks), room=room)
    return replace(mission, zones=(zone,))


def ends_by(known: Known, order: list[int]) -> list[int]:
    """Return when tasks are done if each robot does one, in an order."""
    plan = plan_of_lists(order, [[k] for k in sorted(order)])
    ends: list[int] = time_team_plan(situation_of(known), plan).ends.tolist()
    return ends


@pytest.mark.parametrize(
    ("room", "order", "ends"),
    [
        (1, [0, 1, 2], [4, 7, 10]),
        (1, [2, 1, 0], [11, 8, 5]),
        (2, [0, 1, 2], [4, 5, 7]),
        (2, [2, 1, 0], [8, 5, 5]),
        (3, [2, 1, 0], [4, 5, 5]),
    ],
)
def test_tasks_wait_for_room_in_the_order_of_the_plan(
    room: int, order: list[int], ends: list[int]
) -> None:
    assert ends_by(known_at_start(three(room)), order) == ends


def test_what_is_under_way_takes_room_until_it_ends() -> None:
    """Task 0 goes on until step 12: tasks 1 and 2 have the room after it, one by one."""
    known = known_at_start(three(1))
    known = replace(known, open_tasks=(1, 2), under_way=((0, 12),))
    plan = plan_of_lists([0, 1], [[1], [2]])
    assert time_team_plan(situation_of(known), plan).ends.tolist() == [15, 18]


def test_a_plan_begins_in_the_zone_where_somebody_is_to_go_on_elsewhere() -> None:
    """Two tasks in a zone of one room take 6 steps each, and one elsewhere takes 4.

    . a T . . . . U . . V a        T and V are in the zone: V from 1 to 7, T then to 13, U from 10
    """
    wanted = [task("a", 2, duration=6), task("a", 10, duration=6), task("a", 7, duration=4)]
    mission = make([robot("a", 1), robot("a", 11)], wanted)
    names = tuple(task.name for task in mission.tasks[:2])
    mission = replace(mission, zones=(Zone("dock", tasks=names),))
    record = run_trial(mission, load_method("plan")).record
    assert record.end.makespan == 14
    assert record.end.makespan == plan_mission(known_at_start(mission)).makespan


@pytest.mark.parametrize("setting", ["sparse", "medium", "shifts-steps"])
def test_a_plan_is_carried_out_in_the_steps_that_it_says(setting: str) -> None:
    for number in range(3):
        mission = drawn(setting, number)
        planned = plan_mission(known_at_start(mission))
        record = run_trial(mission, load_method("plan")).record
        assert judge(record).findings == ()
        ends = done_steps(record)
        assert {task: ends[task] for task in planned.order} == dict(
            zip(planned.order, planned.ends, strict=True)
        )


def drawn(setting: str, number: int) -> Mission:
    """Return a drawn mission with zones."""
    rng = np.random.default_rng(number)
    if setting == "shifts-steps":
        return with_zones(world_of("sparse-shifts", number), rng)
    mission = generate(Spec(robots=6, tasks=10 if setting == "sparse" else 24), rng)
    tasks = tuple(replace(task, duration=int(rng.integers(8))) for task in mission.tasks)
    return with_zones(replace(mission, tasks=tasks, step_limit=0), rng)


@pytest.mark.parametrize("name", ["central", "soonest", "reactive", "teamformer-tasks", "crews"])
def test_every_method_keeps_to_the_room(name: str) -> None:
    for number in range(2):
        record = run_trial(drawn("sparse", number), load_method(name)).record
        assert record.end.status == "completed"
        assert judge(record).findings == ()
