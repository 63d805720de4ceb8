"""Why a team does what it does, in words, by what was known then."""

from __future__ import annotations

import math
from collections.abc import Sequence

from teamformer.base.naming import listed
from teamformer.mission.parts.capabilities import describe, missing, total
from teamformer.mission.parts.plane import Plane
from teamformer.mission.parts.shifts import fits_now
from teamformer.mission.parts.zones import may_unload
from teamformer.record.happenings import LogEntry, loss_of
from teamformer.record.phases import (
    AT_WORK,
    CARRYING,
    FORMING,
    IDLE,
    LOST,
    OFF,
    UNLOADING,
    WAITING,
    WHY_AT_CHARGER,
)
from teamformer.record.telling.unrolled import Unrolled
from teamformer.record.told.zones import held_in
from teamformer.world.rules.constants import NEVER, NOBODY

RANKS = ("first", "second", "third")


class Narrator:
    """Tells why teams do what they do in the latest step of a record that is unrolled."""

    def __init__(self, unrolled: Unrolled) -> None:
        self._now = unrolled
        self._news: list[str] = []  # of the step before the latest
        self._plan = ""  # when the plan that holds was made, and after what, if not at the start
        self._useful: dict[tuple[str, ...], list[str]] = {}  # open tasks by what robots can

    def go_on(self) -> None:
        """Go on to the step that the unrolled has gone on to."""
        if self._now.is_planned:
            self._plan = self._planned_anew()
        self._news = self._happened()
        self._useful = {}

    def _happened(self) -> list[str]:
        """Return what happened in the latest step that may have a plan made anew."""
        now, step = self._now, self._now.latest
        found = [
            *(LogEntry(now.steps, "cancelled", task=task) for task in now.called_off),
            *(LogEntry(now.steps, "missed", task=task) for task in now.missed),
            *(loss_of(now.mission, robot, now.steps) for robot in step.lost),
            *(LogEntry(now.steps, "back", (robot,)) for robot in step.back),
            *(LogEntry(now.steps, "found", task=task) for task in step.found),
            *(LogEntry(now.steps, "needs", task=task) for task in step.shown),
            *(LogEntry(now.steps, "appears", task=task) for task in now.news),
        ]
        over = [
            f"the last shift of {robot.name} is over"
            for number, robot in enumerate(now.source.robots)
            if robot.rota.over == now.steps and now.teams.slot[number] != NOBODY
        ]
        return [*(event.text(now.mission) for event in found), *over]

    def _planned_anew(self) -> str:
        plans, world = self._now.plans, self._now.source.world
        if not plans.made:
            return ""
        when = f"after step {plans.made}"
        if isinstance(world, Plane):
            when = f"at {round(plans.made * world.step, 2):g} s"
        taken_over = (
            ["an operator took over a longer search"] if "taken over" in plans.reasons else []
        )
        causes = [*self._news, *taken_over] or plans.reasons
        return f"planned anew {when}{': ' if causes else ''}{', '.join(causes)}"

    def why(self, slot: int) -> tuple[str, ...]:
        """Return why a team does it; nothing where that goes without saying."""
        phase, task = self._now.phases.deeds[slot]
        if phase in (LOST, FORMING):
            return ()
        if phase in AT_WORK:
            return (self._why_at_work(phase),)
        if phase == OFF:
            return (self._why_off(slot),)
        if phase in WHY_AT_CHARGER:
            return (WHY_AT_CHARGER[phase],)
        if phase == IDLE:
            return (self._why_idle(self._now.teams.robots[slot]),)
        if phase == WAITING:
            return (self._why_waiting(slot, task),)
        if task == NOBODY:
            return ()
        return tuple(filter(None, (self._why_task(slot, task), self._plan)))

    def _why_at_work(self, phase: str) -> str:
        if phase in (CARRYING, UNLOADING):
            return "its team brings all that the load takes, and stays with it until it is unloaded"
        return "its team brings all that the task needs, and stays until that is done"

    def _why_off(self, robot: int) -> str:
        now, world = self._now, self._now.source.world
        again = now.source.robots[robot].rota.goes_on(now.steps - 1)
        if math.isinf(again):
            return "its last shift is over"
        if isinstance(world, Plane):
            return f"its next shift begins at {round(again * world.step, 2):g} s"
        return f"its next shift begins after step {again:g}"

    def _why_waiting(self, slot: int, task: int) -> str:
        now, tasks = self._now, self._now.source.tasks
        work = now.at_work
        if task in work.queue:
            full = (room for room in now.rooms if not may_unload([room], work, task))
            return next((held_in(now.source, room, work, ()) for room in full), "")
        over = {tasks[other].name for other in now.before.get(task, ()) if other in now.over}
        before = [name for name in tasks[task].after if name not in over]
        if before:
            return f"the task comes after {', '.join(before)}"
        if now.steps <= now.opens(task) < NEVER:
            return f"the task may not begin before step {now.opens(task) + 1}"
        robots, mates = now.source.robots, now.teams.robots[slot]
        off = [mate for mate in mates if mate in now.off]
        if off:
            return f"{self._names(off)} {'are' if len(off) > 1 else 'is'} off"
        can = total(robots[mate].can for mate in mates)
        short = missing(can, now.mission.tasks[task].needs)
        if not short and self._does_not_fit(mates, task):
            return "the task does not fit into what is left of the shifts of its robots"
        if now.at_chargers.keys() & set(mates):
            return "others of its team charge"
        if not short:
            return self._held_in_a_zone(task) or "its team brings all that the task needs"
        coming = [
            other
            for other in now.heading_for(task)
            if other not in mates and set(short) & set(robots[other].can)
        ]
        who = self._names(coming) or "nobody on the way"
        return f"lacks {describe(short)}, which {who} {'bring' if len(coming) > 1 else 'brings'}"

    def _does_not_fit(self, robots: Sequence[int], task: int) -> bool:
        """Say whether a task is too long for what is left of the shifts of robots."""
        wanted, fleet = self._now.source.tasks[task], self._now.source.robots
        takes = int(wanted.duration) + wanted.unload
        return not fits_now([fleet[robot].rota for robot in robots], self._now.steps, takes)

    def _held_in_a_zone(self, task: int) -> str:
        """Return in which zone a task waits for what; nothing if in none."""
        now, under_way = self._now, self._now.services.under_way
        work, before = now.at_work, []
        if now.plans.has_shared_plan and task in now.plans.order:
            order = now.plans.order[: now.plans.order.index(task)]
            begun = now.over | under_way
            before = [k for k in order if k not in begun and now.plans.coalition(k)]
        for room in now.rooms:
            ahead = {*room.inside(work), *room.tasks.intersection(before)}
            ahead |= room.loads.intersection(work.queue)
            if task in room.tasks and len(ahead) >= room.room:
                return held_in(now.source, room, work, before)
        return ""

    def _why_idle(self, team: Sequence[int]) -> str:
        now = self._now
        if now.plans.has_shared_plan:
            left = [k for mate in team for k in now.plans.tasks_of(mate) if k not in now.over]
            if left:
                following = min(left, key=now.plans.order.index)
                return f"the plan has it do {now.source.tasks[following].name} next"
            return "the plan has nothing left for it" if now.open_tasks() else "no task is open"
        can = total(now.source.robots[mate].can for mate in team)
        useful = self._tasks_that_need(tuple(sorted(can)))
        if useful is None:
            return "no task is open"
        if not useful:
            return "no open task needs what it brings"
        return f"others are to do {listed(useful)}"

    def _tasks_that_need(self, can: tuple[str, ...]) -> list[str] | None:
        """Return the open tasks that need one of some capabilities, by name; None if none is."""
        if can not in self._useful:
            tasks, is_open = self._now.source.tasks, self._now.open_tasks()
            if not is_open:
                return None
            found = (tasks[k] for k in is_open if not set(can).isdisjoint(tasks[k].needs))
            self._useful[can] = [task.name for task in found]
        return self._useful[can]

    def _why_task(self, slot: int, task: int) -> str:
        """Return which plan said so: the policy itself, the plan, or the shared order."""
        now, plans = self._now, self._now.plans
        if slot in now.latest.named:
            return "its policy named the task itself"
        if plans.has_shared_plan:
            looking = plans.scouts_of(task).intersection(now.teams.robots[slot])
            if looking:
                names = self._names(sorted(looking))
                return f"the plan has {names} look first at what is not known of it"
            coalition = plans.coalition(task)
            together = " together" if len(coalition) > 1 else ""
            return f"the plan has {self._names(coalition)} do it{together}" if coalition else ""
        rank = plans.rank(task)
        return "" if rank is None else _ranked(rank)

    def _names(self, robots: Sequence[int]) -> str:
        """Name robots; of many the first, and how many more there are."""
        return listed(self._now.source.robots[robot].name for robot in robots)


def _ranked(rank: int) -> str:
    """Return how a place in the shared order is told."""
    told = RANKS[rank] if rank < len(RANKS) else f"number {rank + 1}"
    order = f"{told} in the order that everybody shares"
    return order if rank == 0 else f"{order}, the first it was sent to"
