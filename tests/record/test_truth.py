"""What an uncertain mission can really be, by hand."""

from __future__ import annotations

from dataclasses import replace

import pytest

from teamformer.mission.model import Absence, Breakdown, Robot, Task
from teamformer.record.referee.truth import _can_be_robot, _can_be_task


@pytest.mark.parametrize(
    ("breaks", "lost", "back", "can_be"),
    [
        (None, None, None, True),
        (None, 3, None, False),
        (Breakdown(0.1), None, None, True),
        (Breakdown(0.1), 3, None, True),
        (Breakdown(0.1), 0, None, False),  # before the first step
        (Breakdown(0.0), 3, None, False),  # it never breaks
        (Breakdown(1.0), None, None, False),  # it breaks at once
        (Breakdown(0.1), 3, 8, False),  # nobody repairs it
        (Breakdown(0.1, (2, 5)), 3, None, False),
        (Breakdown(0.1, (2, 5)), 3, 5, True),
        (Breakdown(0.1, (2, 5)), 3, 8, True),
        (Breakdown(0.1, (2, 5)), 3, 4, False),
        (Breakdown(0.1, (2, 5)), 3, 9, False),
    ],
)
def test_when_a_robot_can_break_down(
    breaks: Breakdown | None, lost: int | None, back: int | None, can_be: bool
) -> None:
    robot = Robot("r", (0, 0), {"a": 1}, breaks=breaks)
    absences = () if lost is None else (Absence(lost, back),)
    real = Robot("r", (0, 0), {"a": 1}, absences=absences)
    assert _can_be_robot(robot, real) is can_be


@pytest.mark.parametrize(
    ("absences", "can_be"),
    [
        ((Absence(3, 5), Absence(6, 8)), True),
        ((Absence(3, 5), Absence(9, 12), Absence(20, 25)), True),
        ((Absence(3, 5), Absence(5, 8)), False),
        ((Absence(3, 5), Absence(9, 15)), False),
        ((Absence(3, 5), Absence(9)), False),
        ((Absence(3), Absence(9, 12)), False),
    ],
)
def test_a_robot_that_is_back_may_break_down_again(
    absences: tuple[Absence, ...], can_be: bool
) -> None:
    robot = Robot("r", (0, 0), {"a": 1}, breaks=Breakdown(0.1, (2, 5)))
    assert _can_be_robot(robot, replace(robot, breaks=None, absences=absences)) is can_be


@pytest.mark.parametrize(
    ("needs", "duration", "can_be"),
    [
        ({"a": 1}, 2, True),
        ({"a": 1}, 4, True),
        ({"a": 1}, 1, False),
        ({"a": 1}, 5, False),
        ({"a": 1, "b": 1}, 3, True),
        ({"a": 1, "b": 2}, 3, False),
        ({"a": 2}, 3, False),
        ({"a": 1, "c": 1}, 3, False),
        ({"b": 1}, 3, False),
    ],
)
def test_what_a_task_can_really_need_and_take(
    needs: dict[str, int], duration: int, can_be: bool
) -> None:
    task = Task("t", (0, 0), {"a": 1}, lasts=(2, 4), may_need={"b": 0.5})
    assert _can_be_task(task, Task("t", (0, 0), needs, duration=duration)) is can_be
