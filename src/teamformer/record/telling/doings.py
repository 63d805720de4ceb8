"""What a robot did in any step, and with whom, of a record that has been told."""

from __future__ import annotations

from bisect import bisect_right
from collections import defaultdict
from collections.abc import Iterator

from teamformer.record.phases import AT_WORK, IDLE, LOADING, OFF, SERVING, WAITING, WALKING
from teamformer.record.record import Record
from teamformer.record.teams import Teams
from teamformer.record.told.told_record import Robots, Run, ToldRecord, ToldService
from teamformer.world.rules.constants import NOBODY


class Doings:
    """What the robots of a record did; `last` is the last service of each task."""

    def __init__(self, record: Record, told: ToldRecord) -> None:
        self._told = told
        self._made = {(task, n) for n, step in enumerate(record.steps, 1) for task, _ in step.done}
        taken = {(task, n) for n, step in enumerate(record.steps, 1) for task, _ in step.taken}
        self.last: dict[int, ToldService] = {}
        self._of: defaultdict[int, list[ToldService]] = defaultdict(list)  # by robot
        self._ended: defaultdict[int, list[tuple[int, Robots]]] = defaultdict(list)
        ends = {SERVING: self._made, LOADING: taken}
        for service in told.services:
            if service.ended is None or (service.task, service.ended) not in ends.get(
                service.doing, {(service.task, service.ended)}
            ):
                continue  # it was broken off and came to nothing
            self.last[service.task] = service
            for robot in {*service.begun_by, *service.robots}:
                self._of[robot].append(service)
        self._note_ends(record)
        self._teams = _teams_by_robot(record)

    def _note_ends(self, record: Record) -> None:
        """Note who was about tasks that were done, and loads that were set down, by step."""
        robots = {(it.task, it.ended): it.robots for it in self._told.services}
        for number, step in enumerate(record.steps, start=1):
            for task in (*(task for task, _ in step.done), *(row.task for row in step.left)):
                self._ended[number].append((task, robots.get((task, number), ())))

    def ended_in(self, step: int) -> Iterator[tuple[int, Robots]]:
        """Yield tasks that were done or loads that were set down in a step, and who had them."""
        yield from self._ended.get(step, ())

    def team(self, robot: int, steps: int) -> Robots:
        """Return the robots of a robot's team after so many steps; of a lost one, nobody."""
        row = self._teams[robot]
        return row[bisect_right(row, steps, key=lambda it: it[0]) - 1][1]

    def service_in(self, robot: int, step: int) -> ToldService | None:
        """Return the service that a robot took part in during a step, if it came to something."""
        team = set(self.team(robot, step))
        for service in self._of.get(robot, ()):
            is_with_it = team & set(service.begun_by) and team & set(service.robots)
            if is_with_it and service.begun < step <= (service.ended or 0):
                return service
        return None

    def pursued(self, robot: int, step: int) -> int:
        """Return the task that a robot was about in a step, or NOBODY."""
        return self._run(robot, step).task

    def doing(self, robot: int, step: int) -> str:
        """Return what a robot did in a step; it waited in a service that came to nothing.

        One that was off walked if it went on walking for the same task then, and waited else.
        """
        run = self._run(robot, step)
        doing = self._done_after(robot, run) if run.phase == OFF else run.phase
        assert doing is not None, "its team's runs say what it did"
        return WAITING if doing in AT_WORK and not self.service_in(robot, step) else doing

    def _done_after(self, robot: int, off: Run) -> str:
        """Return what a robot that was off for a while did but for that."""
        runs = iter(self._told.runs[robot])
        is_next = (run for run in runs if run.begun > off.begun and run.phase != OFF)
        after = next(is_next, off)
        if after.phase is None:
            after = self._run(after.task, int(after.begun) + 1)
        if (after.phase, after.task) == (WALKING, off.task):
            return WALKING
        return IDLE if off.task == NOBODY else WAITING

    def _run(self, robot: int, step: int) -> Run:
        row = self._told.runs[robot]
        run = row[bisect_right(row, float(step - 1), key=lambda it: it.begun) - 1]
        return self._run(run.task, step) if run.phase is None else run


def _teams_by_robot(record: Record) -> list[list[tuple[int, Robots]]]:
    """Return by robot after how many steps it was in which team; in none while it is lost."""
    teams = Teams(record.mission.robots, record.start)
    rows = [[(0, teams.robots.get(slot, ()))] for slot in teams.slot]
    for number, step in enumerate(record.steps, start=1):
        left = {mate for lost in step.lost for mate in teams.robots[teams.slot[lost]]}
        for robot in {*teams.follow(step), *left, *step.back}:
            slot = teams.slot[robot]
            rows[robot].append((number, () if slot == NOBODY else teams.robots[slot]))
    return rows
