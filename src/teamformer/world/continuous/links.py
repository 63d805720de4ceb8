"""Links between the starts of tasks, as a mission runs: when they let a task begin.

A task whose start lies at least so long after another one waits for that. One that starts at most
so long before another has to wait for robots that come later: it is held until then, as foreseen.
Nobody waits for an optional task that the plan leaves out.
"""

from __future__ import annotations

import copy
from collections.abc import Iterable, Mapping

from teamformer.mission.model import Mission
from teamformer.mission.parts.zones import rooms_of, that_share_zones
from teamformer.mission.precedence import tasks_before
from teamformer.world.continuous.body import SAME
from teamformer.world.continuous.world import PhysicalWorld
from teamformer.world.rules.constants import NOBODY
from teamformer.world.rules.starts import Gap, Timed


class GapKeeper:
    """The gaps of a mission, from when on each linked task is held, and how all is foreseen."""

    def __init__(self, mission: Mission) -> None:
        number_of = {task.name: number for number, task in enumerate(mission.tasks)}
        self.gaps = [
            Gap(number, number_of[name], least, most)
            for number, task in enumerate(mission.tasks)
            for name, (least, most) in task.starts.items()
        ]
        self.linked = {task for gap in self.gaps for task in (gap.task, gap.other)}
        self._optional = {task for task in self.linked if mission.tasks[task].optional}
        self.holds: Mapping[int, float] = {}
        self._foreseen: Timed | None = None
        self._has_delays = any(robot.delays for robot in mission.robots)

    def fork(self) -> GapKeeper:
        """Return others that go their own way."""
        return copy.copy(self)

    def foresee(self, timed: Timed, holds: Mapping[int, float]) -> None:
        """Go by another foresight from now on."""
        self._foreseen, self.holds = timed, holds

    def is_off(self, world: PhysicalWorld, tasks: Iterable[int]) -> bool:
        """Say whether some tasks have begun or ended at another time than foreseen.

        Where robots may be delayed nobody knows before, so it is looked at anew while one walks.
        """
        return self._foreseen is not None and any(self._differs(world, task) for task in tasks)

    def free(self, world: PhysicalWorld, ready: Iterable[int]) -> list[int]:
        """Return those of some tasks that are ready which no link keeps from beginning now."""
        free = {task for task in ready if self.holds.get(task, 0.0) <= world.now}
        while kept := {gap.task for gap in self.gaps if self._keeps(world, gap, free)}:
            free -= kept
        return sorted(free)

    def cause(self, world: PhysicalWorld, task: int, robots_of: Mapping[int, Iterable[int]]) -> int:
        """Return on which event it hangs that a held task begins now, NOBODY if on none.

        That is the start of another one, or the latest doing of the robots that do one which is to
        start later.
        """
        for gap in self.gaps:
            begun = world.started.get(gap.other)
            if gap.task == task and begun is not None and self._is_now(world, begun + gap.least):
                return world.served_by[gap.other]
        for gap in self.gaps:
            later = self._start(gap.task)
            if gap.other == task and later is not None and self._is_now(world, later - gap.most):
                doers = robots_of.get(gap.task, ())
                return max((world.bodies[robot].since for robot in doers), default=NOBODY)
        return NOBODY

    def broken(self, world: PhysicalWorld) -> list[Gap]:
        """Return the gaps that were not kept, of tasks that were both done."""
        return [gap for gap in self.gaps if self._is_broken(world, gap)]

    def _is_broken(self, world: PhysicalWorld, gap: Gap) -> bool:
        if not world.done.issuperset((gap.task, gap.other)):
            return False
        between = world.started[gap.task] - world.started[gap.other]
        slack = SAME * max(1.0, world.now)
        return not gap.least - slack <= between <= gap.most + slack

    def _keeps(self, world: PhysicalWorld, gap: Gap, free: set[int]) -> bool:
        """Say whether a gap keeps its task from beginning now, be it with others."""
        if gap.task not in free:
            return False
        begun = world.started.get(gap.other)
        if begun is not None:
            return begun + gap.least > world.now and not self._is_now(world, begun + gap.least)
        if gap.other in world.over or self._is_left_out(world, gap.other):
            return False
        return gap.least > 0 or gap.other not in free

    def _is_left_out(self, world: PhysicalWorld, task: int) -> bool:
        """Say whether everybody knows of an optional task, and the plan leaves it out."""
        return task in self._optional & world.appeared and self._start(task) is None

    def _differs(self, world: PhysicalWorld, task: int) -> bool:
        foreseen = self._start(task)
        if self._foreseen is None or foreseen is None:
            return False
        if task in world.over:
            ended = world.events[world.over[task]].at
            return not _is_near(ended, self._foreseen.end(task), world.now)
        if task in world.started:
            return not _is_near(world.started[task], foreseen, world.now)
        is_held_until_now = self.holds.get(task, world.now + 1) <= world.now
        return self._has_delays and is_held_until_now and world.is_busy

    def _start(self, task: int) -> float | None:
        return None if self._foreseen is None else self._foreseen.start.get(task)

    def _is_now(self, world: PhysicalWorld, moment: float) -> bool:
        return _is_near(moment, world.now, world.now)


def _is_near(one: float, other: float, now: float) -> bool:
    return abs(one - other) <= SAME * max(1.0, now)


def followers(mission: Mission) -> dict[int, set[int]]:
    """Return the tasks that have to be looked at when something of a task changes."""
    after: dict[int, set[int]] = {}
    for task, others in tasks_before(mission.tasks).items():
        for other in others:
            after.setdefault(other, set()).add(task)
    for task, inside in that_share_zones(rooms_of(mission)):
        after.setdefault(task, set()).update(inside - {task})
    number_of = {task.name: number for number, task in enumerate(mission.tasks)}
    for number, wanted in enumerate(mission.tasks):
        for name in wanted.starts:
            after.setdefault(number_of[name], set()).add(number)
            after.setdefault(number, set()).add(number_of[name])
    return after
