"""What an onlooker sees of a fleet on roads, beside what really happened."""

from __future__ import annotations

from pathlib import Path

from fleets import Watched
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.messages import Notice
from teamformer.fleet.rehearsal.faults import Crash, Faults
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.roads import Roads
from teamformer.record.files.reading import read_record
from teamformer.record.files.writing import save_record
from teamformer.record.record import Record
from teamformer.record.referee import judge as judge_record

FAR = float("inf")
RING = Roads(("dock", "ward", "lab"), {"ground": ((0, 4, FAR), (FAR, 0, 2.5), (1, FAR, 0))})


def ward() -> FleetMission:
    """Return three robots at the dock, a bed for two to bring to the lab, and a scan there."""
    robots = tuple(Robot(f"r{n}", (0, 0), {"a": 1}) for n in range(3))
    tasks = (
        Task("bed", (1, 0), {"a": 2}, 3, to=(2, 0), unload=1),
        Task("scan", (2, 0), {"a": 1}, 2.5, after=("bed",)),
    )
    return FleetMission(Mission("ring", RING, ("a",), robots, tasks, time="continuous"))


class Asked(Watched):
    """One who watches and asks who did what, as the session of `fleet watch` does."""

    def _hear(self, robot: int, notice: Notice) -> None:
        super()._hear(robot, notice)
        if self._has_begun and self.watch.wonders:
            self._come()


def seen(since: float = 0.0, faults: Faults | None = None) -> tuple[Watched, Record]:
    """Return a rehearsal that was watched to its end, and what was seen of it."""
    watched = Asked(ward(), since, faults or Faults())
    watched.run(400.0)
    for _ in range(4):
        watched.watch.step()
    return watched, watched.watch.record()


def told(record: Record, kind: str) -> list[tuple[int, tuple[int, ...], float]]:
    return [(event.task, event.robots, event.at) for event in record.events if event.kind == kind]


def test_what_is_seen_is_what_happened_within_two_units_of_time(tmp_path: Path) -> None:
    watched, record = seen()
    assert record.end.status == "completed"
    really = [(done.key, done.robots, done.at) for done in watched.world.done.values()]
    for (task, robots, at), (due_task, due_robots, due) in zip(
        told(record, "done"), really, strict=True
    ):
        assert (task, robots) == (due_task, due_robots)
        assert 0 <= at - due <= 2
    assert [task for task, _, _ in told(record, "lift")] == [0]
    save_record(record, tmp_path / "record.json")
    assert read_record(tmp_path / "record.json") == record
    assert judge_record(record).findings == ()


def test_a_robot_that_others_call_lost_is_seen_to_be_lost() -> None:
    _, record = seen(faults=Faults(crashes=(Crash(2, 1.0),)))
    [(_, robots, at)] = told(record, "lost")
    assert robots == (2,)
    assert 10 <= at <= 25
    assert judge_record(record).findings == ()


def test_who_comes_late_is_told_what_was_done() -> None:
    _, record = seen(since=11.0)
    assert [task for task, _, _ in told(record, "done")] == [0, 1]
    assert judge_record(record).findings == ()
