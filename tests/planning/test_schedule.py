"""The list schedule, against a plain one."""

from __future__ import annotations

import numpy as np
import pytest

from plain_plans import PlainWorld, Stay, find_faults, last_step, schedule_of, serve
from random_worlds import random_world
from small_worlds import make, robot, task
from teamformer.mission.model import Mission
from teamformer.planning.problem.relaxed_problem import relax
from teamformer.trials.list_schedule import schedule_tasks


def list_schedule(mission: Mission, ranking: list[int]) -> tuple[list[int], list[int]] | None:
    """Return each task's start and the size of its crew; None if a task has nobody left."""
    world = PlainWorld(mission)
    stays = [Stay(r.at) for r in world.robots]
    starts, sizes = [0] * len(ranking), [0] * len(ranking)
    for k in ranking:
        crew = first_crew(world, k, stays)
        if not crew:
            return None
        starts[k] = serve(world, world.tasks[k], tuple(crew), stays) - world.tasks[k].duration
        sizes[k] = len(crew)
    return starts, sizes


def first_crew(world: PlainWorld, k: int, stays: list[Stay]) -> list[int]:
    """Return the first robots to come that can do a task; whom they can spare goes, in turn."""
    task = world.tasks[k]
    came = {
        r: stays[r].go(world, one, task).since
        for r, one in enumerate(world.robots)
        if world.is_reachable(one, task) and any(one.can.get(cap) for cap in task.needs)
    }
    in_turn = sorted(came, key=lambda r: (came[r], r))
    for count, last in enumerate(in_turn, start=1):
        end = max(task.appears + 1, came[last]) + task.duration
        crew = [r for r in in_turn[:count] if end < last_step(world.robots[r])]
        if world.covers(tuple(crew), task):
            for r in list(crew):
                without = tuple(other for other in crew if other != r)
                if world.covers(without, task):
                    crew.remove(r)
            return crew
    return []


@pytest.mark.parametrize("seed", range(3))
def test_agrees_with_the_plain_one(seed: int) -> None:
    rng = np.random.default_rng(seed)
    missed = 0
    for _ in range(60):
        mission = random_world(rng)
        ranking = rng.permutation(len(mission.tasks)).tolist()
        problem = relax(mission)
        plan = schedule_tasks(problem, ranking)
        plain = list_schedule(mission, ranking)
        missed += plain is None
        if plain is None:
            assert plan is None
        else:
            assert plan is not None
            schedule = schedule_of(problem, plan)
            assert find_faults(mission, schedule) == []
            assert (schedule.start, [len(crew) for crew in schedule.coalitions]) == plain
            assert schedule.order == ranking
    assert missed < 30


def test_the_crew_that_is_there_first() -> None:
    """b, the nearer a, and then the farther a, which needs not wait for b to come back.

    a . b T a . . U        T needs a, b: b and an a are there at 1. U needs both a's: at 4.
    0 1 2 3 4 5 6 7
    """
    robots = [robot("a", 0), robot("b", 2), robot("a", 4)]
    problem = relax(make(robots, [task("ab", 3), task("aa", 7)]))
    plan = schedule_tasks(problem, [0, 1])
    assert plan is not None
    schedule = schedule_of(problem, plan)
    assert [sorted(robots) for robots in schedule.coalitions] == [[1, 2], [0, 2]]
    assert schedule.start == [1, 7]
