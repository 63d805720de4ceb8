"""Who serves which task in snapshots of a fleet, which say only who stands where and what is done.

What is served is known; it is by the team of those who are known to, if that stands there and has
what the task needs, or else the first that does. It goes on until the task is done or broken off,
or until it has what the task needs no longer. Who takes up a load is known, and has it until it is
down.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from teamformer.mission.model import Mission
from teamformer.mission.parts.capabilities import covers, total
from teamformer.mission.parts.grid import Place
from teamformer.record.phases import is_same_place
from teamformer.record.record import Step
from teamformer.record.teams import Teams
from teamformer.world.rules.constants import NOBODY

Robots = tuple[int, ...]

AtWork = Mapping[int, Robots]
"""The tasks that are served at a moment, each with the robots that are known to."""


class ServicesSeen:
    """Goes through the snapshots of a fleet, one after the other."""

    def __init__(self, mission: Mission) -> None:
        robots = mission.robots
        self._mission = mission
        self._teams = Teams(robots, [(r, (r,), *at.at) for r, at in enumerate(robots)])
        self._steps = 0
        self._serving: dict[int, Robots] = {}  # task -> robots that began it and stayed with it
        self._up: dict[int, int] = {}  # load that is carried -> the step in which it was taken up
        self._over: set[int] = set()
        self._lies: dict[int, Place] = {}  # loads that are not where the mission has them

    @property
    def served(self) -> AtWork:
        """Return the tasks that are being served, with their robots."""
        return dict(self._serving)

    def add(self, steps: list[Step], step: Step, mission: Mission, at_work: AtWork) -> Step:
        """Add a step to others, with who serves what; return it.

        `at_work` has what is served as the step ends. The step before in which a load got to where
        it goes says then that it is unloaded. The mission may have got more tasks.
        """
        self._mission = mission
        self._steps += 1
        self._teams.follow(step)
        rows: list[tuple[int, Robots]] = []
        self._go_on(step, rows, at_work)
        self._begin_more(step, rows, at_work)
        steps.append(replace(step, served=tuple(rows)))
        for task, _ in step.done:
            if task in self._up and (unload := int(mission.tasks[task].unload)):
                at = max(self._up[task], self._steps - unload) - 1
                steps[at] = replace(steps[at], unloads=(*steps[at].unloads, task))
            self._up.pop(task, None)
        return steps[-1]

    def _go_on(self, step: Step, rows: list[tuple[int, Robots]], at_work: AtWork) -> None:
        """Let services go on or end."""
        for task, _ in step.done:
            self._serving.pop(task, None)
            self._over.add(task)
        for task, _ in step.missed:
            self._end(task, rows)
            self._over.add(task)
        for task, x, y in step.left:
            self._end(task, rows)
            self._lies[task] = (x, y)
        for task in sorted(self._serving.keys() - at_work.keys() - self._up.keys()):
            self._end(task, rows)
        for task, robots in list(self._serving.items()):
            going = self._going_on(task, robots, dict(step.taken).get(task))
            if not going:
                self._end(task, rows)
                if self._up.pop(task, None) is not None:
                    self._lies[task] = self._teams.place(min(robots))
            elif going != robots:
                self._serving[task] = going
                rows.append((task, going))

    def _end(self, task: int, rows: list[tuple[int, Robots]]) -> None:
        if self._serving.pop(task, ()):
            rows.append((task, ()))

    def _begin_more(self, step: Step, rows: list[tuple[int, Robots]], at_work: AtWork) -> None:
        """Let teams begin: those that take up a load, and of the others the first that can."""
        taken = {k: slot for k, slot in step.taken if self._is_load(k) and k not in self._over}
        let_go = {row.task for row in step.left}
        free = self._free() & at_work.keys() - let_go | (taken.keys() - self._serving.keys())
        for task in sorted(free, key=lambda k: (not self._is_load(k), k)):
            slot = taken.get(task, self._first_able(task, at_work.get(task, ())))
            if slot is not None:
                self._serving[task] = self._teams.robots[slot]
                rows.append((task, self._serving[task]))
        self._up |= dict.fromkeys(taken, self._steps)

    def _free(self) -> set[int]:
        """Return the tasks that take a while, may begin, and that nobody serves."""
        return {
            task
            for task, wanted in enumerate(self._mission.tasks)
            if (wanted.duration > 0 or wanted.to is not None)
            and task not in self._over
            and wanted.appears < self._steps
            and task not in self._serving
        }

    def _going_on(self, task: int, robots: Robots, taker: int | None) -> Robots:
        """Return which robots of a service go on with it; `taker` takes its load up.

        Of a team that has parted the first part that can goes on. If those part who have a load up,
        those have it that can carry it and head for nothing else; if no part can, all that head for
        nothing else.
        """
        there = {robot: self._teams.slot[robot] for robot in robots}
        there = {robot: slot for robot, slot in there.items() if slot != NOBODY}
        slots = list(there.values())
        if taker is not None:
            slots = [taker]
        elif task in self._up:
            about = [slot for slot in slots if self._is_about(slot, task)]
            slots = [slot for slot in about if self._is_able(slot, task)] or about or slots
        else:
            slots = [slot for slot in slots if self._can_serve(slot, task)][:1]
        return tuple(robot for robot, slot in there.items() if slot in slots)

    def _first_able(self, task: int, robots: Robots) -> int | None:
        """Return the team of some robots, or else the first, that can begin a task.

        It is one that has no load.
        """
        loads = (robots for other, robots in self._serving.items() if self._is_load(other))
        busy = {self._teams.slot[robot] for robots in loads for robot in robots}
        able = (slot for slot in self._teams.robots if slot not in busy)
        able = (slot for slot in able if self._can_begin(slot, task))
        known = set(robots)
        return min(
            able,
            key=lambda slot: (-len(known.intersection(self._teams.robots[slot])), slot),
            default=None,
        )

    def _can_begin(self, slot: int, task: int) -> bool:
        is_meant = not self._is_load(task) or self._teams.task[slot] == task
        return is_meant and self._can_serve(slot, task)

    def _can_serve(self, slot: int, task: int) -> bool:
        lies = self._lies.get(task, self._mission.tasks[task].at)
        is_there = is_same_place(self._mission, self._teams.at[slot], lies)
        return is_there and self._is_about(slot, task) and self._is_able(slot, task)

    def _is_about(self, slot: int, task: int) -> bool:
        """Say whether a team heads for no other task than a load."""
        return not self._is_load(task) or self._teams.task[slot] in (task, NOBODY)

    def _is_able(self, slot: int, task: int) -> bool:
        robots = (self._mission.robots[robot] for robot in self._teams.robots[slot])
        return covers(total(robot.can for robot in robots), self._mission.tasks[task].needs)

    def _is_load(self, task: int) -> bool:
        return self._mission.tasks[task].to is not None
