"""What is told of robots that work in shifts in steps: when they are off, why, what that costs."""

from __future__ import annotations

from small_worlds import at_work, make, robot, service, task
from teamformer.methods.by_name import load_method
from teamformer.mission.model import Mission
from teamformer.record.critical_path.words import why_so_late
from teamformer.record.telling.whole import told_of
from teamformer.record.told.told_record import ToldRecord
from teamformer.trials.trial import run_trial

Shifts = tuple[tuple[int, int], ...]


def told(mission: Mission, *shifts: Shifts) -> ToldRecord:
    """Return what is told of a run of a mission whose robots have shifts, one after the other."""
    return told_of(run_trial(at_work(mission, *shifts), load_method("plan")).record)


def doings(found: ToldRecord, number: int) -> list[tuple[float, str | None]]:
    """Return since when a robot did what."""
    return [(run.begun, run.phase) for run in found.runs[number]]


def test_a_walk_that_pauses_is_told_with_what_it_costs() -> None:
    mission = make([robot("a", 0)], [task("a", 6)])
    found = told(mission, ((2, 5), (7, 13)))
    assert doings(found, 0) == [(0, "off"), (2, "walking"), (5, "off"), (7, "walking")]
    assert found.texts[found.runs[0][2].why[0]] == "its next shift begins after step 7"
    assert why_so_late(mission, found.path) == [
        "why so late: 10 steps are 6 walking, 4 waiting for shifts",
        "  0-10: t0: r0 waits for its shift 2, walks 3, waits for its shift 2, walks 3",
    ]


def test_who_waits_for_a_mate_that_is_off_is_not_off_itself() -> None:
    """Both are at the task after a step, and three steps of service fit from 5 on."""
    found = told(service(3), ((0, 3), (5, 9)), ())
    why = [found.texts[run.why[0]] for run in found.runs[0]]
    assert doings(found, 0) == [(0, "walking"), (1, "waiting"), (3, "off"), (5, "serving")]
    assert why[1] == "the task does not fit into what is left of the shifts of its robots"
    assert doings(found, 1) == [(0, None), (3, "waiting"), (5, None)]
    other = told(service(3), (), ((0, 3), (5, 9)))
    assert doings(other, 0) == [(0, "walking"), (1, "waiting"), (5, "serving")]
    assert doings(other, 1) == [(0, None), (3, "off"), (5, None)]


def test_what_hangs_on_a_pause_is_the_way_of_who_comes_last() -> None:
    mission = make([robot("a", 0), robot("b", 4)], [task("ab", 6)])
    found = told(mission, ((0, 4), (8, 20)), ((0, 3), (6, 20)))
    assert why_so_late(mission, found.path)[1] == (
        "  0-11: t0: r0 walks 4, waits for its shift 4, walks 2, forms a team 1"
    )
