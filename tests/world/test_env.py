"""The environment: what it refuses, and when its threads end."""

from __future__ import annotations

import threading
from typing import Any

import numpy as np
import pytest

from small_worlds import two_robots_one_task
from teamformer.world.env import Decision, TeamFormation


def test_a_decision_answers_the_latest_view_only() -> None:
    env = TeamFormation([two_robots_one_task()])
    with pytest.raises(ValueError, match="call view"):
        env.step(Decision(np.zeros((0, 3), dtype=np.int16)))
    decision = Decision(env.view().counts.copy())
    env.step(decision)
    with pytest.raises(ValueError, match="call view"):
        env.step(decision)
    assert env.tally().steps == 1
    env.view()
    env.reset()
    with pytest.raises(ValueError, match="call view"):
        env.step(decision)
    env.view()
    env.step(decision)
    assert env.tally().steps == 1


@pytest.mark.parametrize(
    ("first", "fault"),
    [
        (2**31, "wanted holds what is no whole number of 32 bits"),
        (-(2**32) + 1, "wanted holds what is no whole number of 32 bits"),
        (0.5, "wanted holds what is no whole number of 32 bits"),
        (float("nan"), "wanted holds what is no whole number of 32 bits"),
        (float("inf"), "wanted holds what is no whole number of 32 bits"),
        ("1", "use whole numbers"),
        (10**30, "use whole numbers"),
        (None, "use whole numbers"),
    ],
)
def test_counts_that_are_no_counts_are_refused(first: Any, fault: str) -> None:
    env = TeamFormation([two_robots_one_task()])
    env.view()
    with pytest.raises(ValueError, match=fault):
        env.step(Decision(np.array([[first, 0, 0], [0, 1, 0]])))
    env.step(Decision(np.array([[2**15 - 1, 0.0, 0], [0, 1, 0]])))  # whole, if far too much
    assert (env.tally().steps, env.tally().illegal_decisions) == (1, 1)


def test_tasks_that_are_no_numbers_are_refused() -> None:
    env = TeamFormation([two_robots_one_task()])
    counts = env.view().counts.copy()
    for wrong in (0.5, 2**31):
        with pytest.raises(ValueError, match="task holds"):
            env.step(Decision(counts, np.array([wrong, 0])))
    env.step(Decision(counts, np.array([0, -1])))


def test_no_mission_and_no_thread_are_refused() -> None:
    with pytest.raises(ValueError, match="there is no mission; give one or more"):
        TeamFormation([])
    with pytest.raises(ValueError, match="threads is 0; use 1 or more"):
        TeamFormation([two_robots_one_task()], threads=0)


def test_closing_ends_the_threads_and_nothing_else() -> None:
    before = threading.active_count()
    with TeamFormation([two_robots_one_task()] * 4, threads=2) as env:
        env.step(Decision(env.view().counts.copy()))
        assert threading.active_count() > before
    assert threading.active_count() == before
    env.step(Decision(env.view().counts.copy()))
    assert [env.tally(w).steps for w in range(4)] == [2] * 4
    env.close()
