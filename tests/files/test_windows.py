"""Windows that precedence makes impossible to keep, and such that it does not."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from small_worlds import make, robot, task
from teamformer.mission.checks.windows import find_hopeless_windows
from teamformer.mission.model import Mission, Task

FIRST = replace(task("a", 3, duration=4), between=(20, 30))


def mission(then: Task, first: Task = FIRST, **rules: Any) -> Mission:
    """Return a mission in which t1 is after t0."""
    small = make([robot("a", 0)], [first, then])
    tasks = (small.tasks[0], replace(small.tasks[1], after=("t0",)))
    return replace(small, tasks=tasks, **rules)


@pytest.mark.parametrize(("time", "end"), [("steps", 27), ("continuous", 25)])
def test_a_window_may_end_when_the_task_can_and_no_earlier(time: str, end: int) -> None:
    """t0 takes 4 from 20 on and t1 takes 1: in steps each begins in the step after it may."""
    then = replace(task("a", 5, duration=1), between=(0, end))
    assert list(find_hopeless_windows(mission(then, time=time))) == []
    [problem] = find_hopeless_windows(mission(replace(then, between=(0, end - 0.5)), time=time))
    assert problem.where == ("tasks", 1, "between")
    assert f"by {end - 0.5:g}, but ends at {end} at the earliest" in problem.message


def test_what_may_turn_out_to_be_short_is_no_fault() -> None:
    """t0 is done in step 22 at the earliest, t1 in step 23."""
    then = replace(task("a", 5), between=(0, 23))
    open_ended = replace(FIRST, lasts=(1, 9))
    assert list(find_hopeless_windows(mission(then, open_ended))) == []
    [_] = find_hopeless_windows(mission(replace(then, between=(0, 22)), open_ended))


def test_a_window_that_is_too_short_by_itself_is_no_matter_of_precedence() -> None:
    """In steps that may turn out when the task is done; t0 has long been done then."""
    then = replace(task("a", 5, duration=9), between=(40, 42))
    assert list(find_hopeless_windows(mission(then))) == []
