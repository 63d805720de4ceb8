"""Nobody knows of a task before it appears: another future changes nothing until then."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from teamformer.files.drawn.named_settings import new_tasks_of, world_of
from teamformer.methods.by_name import Method, load_method
from teamformer.methods.listings import our_method_names
from teamformer.mission.model import Mission, Task
from teamformer.trials.trial import begin, decide
from teamformer.world.env import Decision, TeamFormation
from teamformer.world.view import View

MINE = [name for name in our_method_names() if not load_method(name).needs_everything]
FITTING = [name for name in MINE if not name.endswith(("-c8", "-c100", "-ppo"))]  # networks once


def with_another_future(mission: Mission, kept: int) -> Mission:
    """Move the late tasks, change what they need, and leave some of them out."""
    known = [task for task in mission.tasks if task.appears == 0]
    late = [task for task in mission.tasks if task.appears > 0]
    others: list[Task] = [
        replace(task, at=(9 - task.at[0], 9 - task.at[1]), needs={"c1": 1}) for task in late[:kept]
    ]
    return replace(mission, tasks=(*known, *others))


def play(mission: Mission, method: Method, steps: int) -> list[tuple[View, Decision]]:
    """Return what is seen and decided in the first steps."""
    begin(method, [mission], [mission], seed=0)
    env = TeamFormation([mission], coordinator=method.coordinator, new_tasks=method.new_tasks)
    seen = []
    for _ in range(steps):
        view = View(*(part.copy() for part in env.view()))
        decision = decide(env, method, view)
        seen.append((view, decision))
        env.step(decision)
    return seen


def assert_alike(one: tuple[View, Decision], other: tuple[View, Decision]) -> None:
    for name, ours, theirs in zip(View._fields, one[0], other[0], strict=True):
        assert np.array_equal(ours, theirs), name
    assert np.array_equal(one[1].wanted, other[1].wanted)


SETTINGS = ("4N20+20T-C4-tsp", "4N20+20T-C4-nn")


@pytest.mark.parametrize("name", FITTING)
def test_nobody_knows_of_the_future(name: str) -> None:
    assert {"plan", "crews", "teamformer"} < set(FITTING)
    check_another_future(name, SETTINGS[0], seeds=1)


@pytest.mark.slow
@pytest.mark.parametrize("name", FITTING)
@pytest.mark.parametrize("setting", SETTINGS)
def test_nobody_knows_of_the_future_however_tasks_are_inserted(name: str, setting: str) -> None:
    check_another_future(name, setting, seeds=2)


def check_another_future(name: str, setting: str, seeds: int) -> None:
    method = replace(load_method(name), new_tasks=new_tasks_of(setting))
    for seed in range(seeds):
        mission = world_of(setting, seed)
        appears = mission.tasks[-1].appears
        steps = appears + 1  # the view after `appears` steps is the first to know
        now = play(mission, method, steps)
        for kept in (20, 7):
            then = play(with_another_future(mission, kept), method, steps)
            for step in range(appears):
                assert_alike(now[step], then[step])
            with pytest.raises(AssertionError):
                assert_alike(now[appears], then[appears])
