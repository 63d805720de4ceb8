"""The checker finds every kind of broken promise in traces made by hand."""

from __future__ import annotations

from collections.abc import Sequence

from fleets import pair, walked
from teamformer.fleet.messages import READY, SERVE
from teamformer.fleet.rehearsal.checking.checker import Checker
from teamformer.fleet.rehearsal.checking.trace import Accepted, Event, Finished, Said, Worked
from teamformer.world.rules.constants import NOBODY

GOOD: list[Event] = [
    walked(0.0, 0, tuple((x, 0) for x in range(7)), 0.0, 1.0),
    walked(0.0, 1, ((4, 0), (5, 0), (6, 0)), 0.0, 1.0),
    Said(2.1, 1, 0, 0, READY, 8.0),
    Said(6.1, 0, 0, 0, READY, 2.6),
    Worked(6.2, 0, 0, 0),
    Said(6.2, 0, 0, 0, SERVE, 2.6),
    Worked(6.3, 1, 0, 0),
    Said(6.3, 1, 0, 0, SERVE, 2.6),
    Finished(8.3, 0),
    Worked(8.3, 0, NOBODY, NOBODY),
    Worked(8.3, 1, NOBODY, NOBODY),
]


def found(events: Sequence[Event], undone: Sequence[int] = ()) -> str:
    mission = pair()
    tasks = {task.key: task for task in mission.tasks}
    return "\n".join(Checker(mission, tasks).check(events, undone))


def test_a_good_trace_is_good() -> None:
    assert found(GOOD) == ""


def test_to_begin_alone_is_found() -> None:
    assert "begins to serve task 't0' although" in found([e for e in GOOD if e != GOOD[2]])


def test_to_begin_what_is_done_already_is_no_fault() -> None:
    """A mind that learns late that its task is done; the other one has left, as it may."""
    late = walked(8.4, 1, ((6, 0), (5, 0)), 8.4, 1.0)
    assert found([*GOOD, late, Worked(9.5, 0, 0, 0), Worked(9.6, 0, NOBODY, NOBODY)]) == ""


def test_to_begin_what_was_done_long_ago_is_found() -> None:
    """No body reports so late: 3.2 s after the task was done."""
    late = walked(8.4, 1, ((6, 0), (5, 0)), 8.4, 1.0)
    assert "begins to serve task 't0' although" in found([*GOOD, late, Worked(11.5, 0, 0, 0)])


def test_to_be_elsewhere_is_found() -> None:
    late = walked(0.0, 0, tuple((x, 0) for x in range(7)), 1.0, 1.0)
    assert "serves task 't0' without being there" in found([late, *GOOD[1:]])


def test_to_leave_too_early_is_found() -> None:
    leaving = walked(6.15, 1, ((6, 0), (5, 0)), 6.15, 1.0)
    assert "'r1' leaves task 't0' 3.95 s before" in found([*GOOD[:4], leaving])


def test_to_do_a_task_twice_is_found() -> None:
    assert "is done a second time" in found([*GOOD, Finished(12.0, 0)])


def test_too_short_a_service_is_found() -> None:
    early = [Finished(8.0, 0) if event == GOOD[8] else event for event in GOOD]
    assert "is done without its service" in found(early)


def test_two_teams_do_not_add_up() -> None:
    apart = [Worked(6.3, 1, 0, 1) if event == GOOD[6] else event for event in GOOD]
    assert "is done without its service" in found(apart)


def test_to_say_one_task_and_do_another_is_found() -> None:
    assert "says it does another" in found([*GOOD[:3], Said(6.1, 0, 0, 7, 1, 0.0), GOOD[4]])


def test_what_is_forgotten_is_found() -> None:
    assert found([Accepted(1.0, 0, (0, 1))], [0]) == "task 't0' is forgotten, accepted at 1.00 s"
