"""Whether zones have room for what robots of a trace begin."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping

from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.messages import TaskFact
from teamformer.fleet.rehearsal.checking.trace import Followed, Worked
from teamformer.mission.parts.zones import Zone
from teamformer.world.rules.constants import NOBODY


class ZoneChecker:
    """Knows which robots are in the plan of each robot; `tasks` are all, as they really are."""

    def __init__(self, mission: FleetMission, tasks: Mapping[int, TaskFact]) -> None:
        self._source, self._tasks = mission.source, tasks
        self._live = [frozenset(range(mission.robots))] * mission.robots

    def follow(self, event: Followed) -> None:
        """Note that a robot follows another plan."""
        self._live[event.robot] = event.live

    def full(self, event: Worked, at_work: Mapping[int, int], over: Collection[int]) -> str:
        """Return a zone without room for what a robot begins; nothing if there is room.

        `at_work` has the tasks that robots are at work on, or NOBODY. Those that are `over` take no
        room, nor those of robots that do not count on this one, or it on them.
        """
        going = {
            task
            for robot, task in at_work.items()
            if task not in (NOBODY, event.task, *over) and self._know(robot, event.robot)
        }
        if any(task == event.task for robot, task in at_work.items() if robot != event.robot):
            return ""  # it goes on already
        for zone in self._zones_of(event.task):
            others = [task for task in going if zone in self._zones_of(task)]
            if len(others) >= zone.room:
                return zone.name
        return ""

    def _know(self, one: int, other: int) -> bool:
        return one in self._live[other] and other in self._live[one]

    def _zones_of(self, key: int) -> Iterator[Zone]:
        own, task = self._source.tasks, self._tasks[key]
        for zone in self._source.zones:
            is_named = key < len(own) and own[key].name in zone.tasks
            if is_named or zone.has_place(own[key].at if key < len(own) else (task.x, task.y)):
                yield zone
