"""What is told of zones in missions in steps: who waits for what, and on what the end hung."""

from __future__ import annotations

from dataclasses import replace

from small_worlds import make, robot, task
from teamformer.mission.coordination import Known, Plan
from teamformer.mission.model import Mission, as_believed
from teamformer.mission.parts.zones import Zone
from teamformer.record.critical_path.stretches import path_rows
from teamformer.record.critical_path.words import why_so_late
from teamformer.record.files.truths import truth_from_tree, truth_to_tree
from teamformer.record.record import Record
from teamformer.record.telling.whole import told_of
from teamformer.trials.trial import run_trial


class InTurn:
    """Gives each robot a task, in an order, at the start only."""

    heeds = ()

    def __init__(self, order: tuple[int, ...]) -> None:
        self._order = order

    def update(self, known: Known, plan: Plan | None) -> Plan:
        """Return the plan."""
        return Plan(self._order, tuple((robot,) for robot in self._order))


def dock(room: int) -> Mission:
    """Return robots at 1, 3 and 7 and tasks of 3 steps at 2, 5 and 9, with room for so many."""
    wanted = [task("a", x, duration=3) for x in (2, 5, 9)]
    mission = make([robot("a", x) for x in (1, 3, 7)], wanted)
    zone = Zone("dock", tasks=tuple(task.name for task in mission.tasks), room=room)
    return replace(mission, zones=(zone,))


def waits(record: Record, robot: int) -> list[tuple[float, str]]:
    """Return from when on a robot waits, and why."""
    told = told_of(record)
    return [
        (run.begun, told.texts[run.why[0]]) for run in told.runs[robot] if run.phase == "waiting"
    ]


def test_who_waits_says_for_which_room_and_the_path_whose_it_was() -> None:
    """r2 serves in steps 3 to 5, r1 to 8, r0 to 11; r0 is there after step 1."""
    record = run_trial(dock(1), InTurn((2, 1, 0))).record
    assert waits(record, 0) == [
        (1, "the plan has t2 enter dock before it"),
        (2, "it waits for room in dock, where t2 goes on"),
        (5, "it waits for room in dock, where t1 goes on"),
    ]
    assert waits(record, 1) == [(2, "it waits for room in dock, where t2 goes on")]
    path = told_of(record).path
    assert why_so_late(record.mission, path) == [
        "why so late: 11 steps are 2 walking, 9 serving",
        "  0-5: t2: r2 walks 2, serves 3",
        "  5-8: t1: r1 has waited for room in dock, serves 3",
        "  8-11: t0: r0 has waited for room in dock, serves 3",
    ]
    assert [row.get("room in") for row in path_rows(record.mission, path)] == [
        None, None, "dock", "dock",
    ]  # fmt: skip


def test_a_zone_with_room_for_two_is_full_with_two() -> None:
    """r2 waits from step 2 until r0 has done its task, in step 4."""
    record = run_trial(dock(2), InTurn((0, 1, 2))).record
    assert waits(record, 2) == [(2, "it waits for room in dock, where t0, t1 go on")]
    assert record.end.makespan == 7


def test_a_task_that_is_looked_for_may_turn_out_to_be_outside_the_zone() -> None:
    """The area holds x = 9 only; the task may be at 8, 9 or 10, and is at 8."""
    mission = make([robot("a", 1)], [replace(task("a", 9), within=1)])
    sought = mission.tasks[0]
    mission = replace(mission, zones=(Zone("dock", area=((9, 0), (9, 0))),))
    truth = as_believed(mission, tasks=(sought.once_known((8, 0), sought.needs, 0),))
    read = truth_from_tree(mission, truth_to_tree(mission, truth))
    assert (read.tasks[0].at, read.zones) == ((8, 0), mission.zones)
