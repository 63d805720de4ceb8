"""The teams of a record, as its steps change them: the one place where records are unrolled."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from teamformer.mission.model import Robot
from teamformer.mission.parts.grid import Place
from teamformer.record.record import Record, StartingTeam, Step, TeamAt
from teamformer.world.rules.constants import NOBODY


class Teams:
    """Who is together, where, and heading for what, after some of a record's steps.

    A team is named by its slot, the lowest number of its robots. `robots`, `at` and `task` hold, by
    slot, a team's robots in order, its place, and the task that it heads for or NOBODY; `slot`
    holds the slot of each robot's team, NOBODY while the robot is lost.
    """

    def __init__(self, fleet: Sequence[Robot], start: Sequence[StartingTeam]) -> None:
        """Begin where a record begins, before its first step."""
        self.slot = [NOBODY] * len(fleet)
        self.robots: dict[int, tuple[int, ...]] = {}
        self.at: dict[int, Place] = {}
        self.task: dict[int, int] = {}
        self._left_at: list[Place] = [robot.at for robot in fleet]  # of robots that are lost
        for _, robots, x, y in start:
            self._found(robots, (x, y), NOBODY)

    def follow(self, step: Step) -> set[int]:
        """Make all that a step changed, in order; return the robots that it split or joined."""
        formed: set[int] = set()
        for stay, leave in step.splits:
            self.split(stay, leave)
            formed.update(stay, leave)
        for one, other in step.joins:
            formed.update(self.join(one, other))
        for robot in step.lost:
            self.lose(robot)
        for robot in step.back:
            self.bring_back(robot)
        self.put(step.teams)
        return formed

    def put(self, rows: Iterable[TeamAt]) -> None:
        """Put teams where they are after a step."""
        for slot, x, y, task in rows:
            self.at[slot], self.task[slot] = (x, y), NOBODY if task is None else task

    def row(self, slot: int) -> TeamAt:
        """Return where a team is and what it heads for, as a step tells it."""
        task = self.task[slot]
        return TeamAt(slot, *self.at[slot], None if task == NOBODY else task)

    def lost(self) -> list[int]:
        """Return the robots that are lost."""
        return [robot for robot, slot in enumerate(self.slot) if slot == NOBODY]

    def split(self, stay: Sequence[int], leave: Sequence[int]) -> None:
        """Make two teams of one; that of the lowest robot keeps the slot and the task."""
        slot = self.slot[stay[0]]
        _, at, task = self._dissolve(slot)
        for robots in (stay, leave):
            self._found(robots, at, task if min(robots) == slot else NOBODY)

    def join(self, one: int, other: int) -> tuple[int, ...]:
        """Make one team of those of two slots, at the place of the lower; return its robots."""
        slot = min(one, other)
        at, task = self.at[slot], self.task[slot]
        robots = (*self._dissolve(one)[0], *self._dissolve(other)[0])
        return self._found(robots, at, task)

    def lose(self, robot: int) -> None:
        """Take a robot out of its team, which goes on without it."""
        robots, at, task = self._dissolve(self.slot[robot])
        self.slot[robot], self._left_at[robot] = NOBODY, at
        if rest := [mate for mate in robots if mate != robot]:
            self._found(rest, at, task)

    def bring_back(self, robot: int) -> None:
        """Have a robot back where it was lost, a team of its own."""
        self._found((robot,), self._left_at[robot], NOBODY)

    def doers(self, slot: int | None) -> tuple[int, ...]:
        """Return the robots of a team that did a task; nobody where nobody knows the team."""
        return () if slot is None else self.robots[slot]

    def place(self, robot: int) -> Place:
        """Return where a robot is; of a lost one, where it was lost."""
        slot = self.slot[robot]
        return self._left_at[robot] if slot == NOBODY else self.at[slot]

    def _found(self, robots: Sequence[int], at: Place, task: int) -> tuple[int, ...]:
        """Make robots a team, and return them in order."""
        members = tuple(sorted(robots))
        slot = members[0]
        self.robots[slot], self.at[slot], self.task[slot] = members, at, task
        for robot in members:
            self.slot[robot] = slot
        return members

    def _dissolve(self, slot: int) -> tuple[tuple[int, ...], Place, int]:
        """Take a team out; return its robots, its place and its task."""
        return self.robots.pop(slot), self.at.pop(slot), self.task.pop(slot)


def completions(record: Record) -> Iterator[tuple[float, int, tuple[int, ...]]]:
    """Yield step or moment, task and robots of every task that was done, in order."""
    if record.is_continuous:
        yield from ((it.at, it.task, it.robots) for it in record.events if it.kind == "done")
        return
    teams = Teams(record.mission.robots, record.start)
    for number, step in enumerate(record.steps, start=1):
        teams.follow(step)
        for task, slot in step.done:
            yield number, task, teams.doers(slot)
