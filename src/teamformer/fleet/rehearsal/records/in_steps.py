"""Turns the trace of a rehearsal into a record that `view` shows: one step of it a step of time.

Robots that say they are in one team, and are in one place, are drawn as a team. Those that did a
task, or took up a load, are drawn as a team where they did to the end of the step, though they may
have gone on. If some of them did another task with others in the same step, that is drawn in the
next; so is a load that they took up then. Operators' tasks are tasks that appear.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace

from teamformer.fleet.bodies.journey import Journey
from teamformer.fleet.bodies.walking import Lifted, Walked
from teamformer.fleet.fleet_mission import place_in
from teamformer.fleet.rehearsal.checking.trace import (
    NEEDS,
    Believed,
    Event,
    Finished,
    Noticed,
    Said,
    Sent,
)
from teamformer.fleet.rehearsal.faults import Faults
from teamformer.fleet.rehearsal.outcome import Outcome
from teamformer.fleet.rehearsal.play import Rehearsal
from teamformer.fleet.rehearsal.records.at_chargers import AtChargers, dry_in
from teamformer.mission.model import Absence, Mission, Robot, Task
from teamformer.mission.parts.grid import Grid, Place
from teamformer.mission.parts.plane import DECIMALS
from teamformer.record.record import HEARD, Record, TaskAt
from teamformer.record.snapshots.deeds import SLACK, Deed, deed_of, deeds_by_step
from teamformer.record.snapshots.writer import Sighting, SnapshotWriter, fleet_record
from teamformer.world.continuous.events import Event as OfWorld
from teamformer.world.continuous.events import Passed
from teamformer.world.rules.constants import NOBODY

STATUSES = {
    "ended": "completed",
    "infeasible": "infeasible",
    "too late": "too late",
    "blocked": "step limit",
}
"""How a record says that a rehearsal ended."""


def record_in_steps(
    rehearsal: Rehearsal, outcome: Outcome, events: Sequence[Event], seed: int
) -> Record:
    """Return the record of a rehearsal of a mission in steps."""
    mission = rehearsal.mission
    tasks, number = tasks_of(rehearsal)
    done = rehearsal.world.done.values()
    truth = true_tasks_of(rehearsal, tasks)
    by_key = {it.key: deed_of(number[it.key], truth, it.robots) for it in done}
    finished = ((event.at, event.task) for event in events if isinstance(event, Finished))
    deeds = deeds_by_step(finished, by_key, mission.step)
    offs = (math.ceil(task.cancelled) for task in tasks if task.cancelled is not None)
    off = max((at for at in offs if (at - 1) * mission.step <= outcome.end), default=0)
    length = max(math.ceil((outcome.end - SLACK) / mission.step), off)
    deeds += [[] for _ in range(len(deeds), length)]
    status, until = STATUSES[outcome.status], mission.source.until
    missed = dict[int, Collection[int]]()
    if until is not None and status in ("completed", "too late"):  # the rest is given up
        over = {deed.task for row in deeds for deed in row}
        over |= {n for n, task in enumerate(tasks) if task.cancelled is not None}
        missed[min(len(deeds), int(until))] = {*range(len(tasks))} - over
    busy_until = _busy_until(deeds)
    robots = _robots_of(rehearsal, busy_until)
    source = replace(mission.source, tasks=tasks, robots=robots, teams=(), arrivals=None)
    ends = ((robot, at.lost_for_good) for robot, at in enumerate(robots))
    lost = {robot: int(step) for robot, step in ends if step is not None}
    for robot, step in dry_in(events, mission.step).items():
        lost.setdefault(robot, max(step, busy_until.get(robot, 0) + 1))
    true = replace(source, tasks=truth)
    writer = SnapshotWriter(true)
    _Teller(true, mission.step, number).tell(writer, events, deeds, lost, missed)
    known = true if source.has_surprises else None
    return fleet_record(source, writer.steps, status, seed, blocked_of(outcome, tasks), known)


def blocked_of(outcome: Outcome, tasks: Sequence[Task]) -> tuple[str, ...]:
    """Return the tasks of a record that can never be done; others nobody has accepted."""
    names = {task.name for task in tasks}
    return tuple(name for name in outcome.blocked_tasks if name in names)


def true_tasks_of(rehearsal: Rehearsal, tasks: Sequence[Task]) -> tuple[Task, ...]:
    """Return the tasks as they really were; operators' are as they said."""
    count = len(rehearsal.mission.tasks)
    own = zip(tasks[:count], rehearsal.truth.tasks, strict=False)
    known = (task.once_known(true.at, true.needs, true.duration) for task, true in own)
    return (*known, *tasks[count:])


def tasks_of(rehearsal: Rehearsal) -> tuple[tuple[Task, ...], dict[int, int]]:
    """Return the tasks with those that operators added, and the number of each by its key.

    A task that nobody has accepted is none of the fleet's.
    """
    mission, whole = rehearsal.mission, rehearsal.mission.source
    orders = [it for it in rehearsal.faults.orders if rehearsal.is_promised(it.task.key)]
    added = [
        Task(
            order.task.name,
            place_in(whole.world, (order.task.x, order.task.y)),
            {
                cap: need
                for cap, need in zip(whole.capabilities, order.task.needs, strict=True)
                if need
            },
            mission.in_time(order.task.duration),
            order.at if whole.time == "continuous" else math.ceil(order.at / mission.step),
            optional=mission.may_miss_added,
        )
        for order in orders
    ]
    number = {task.key: task.key for task in mission.tasks}
    number |= {order.task.key: len(mission.tasks) + k for k, order in enumerate(orders)}
    return (*_with_call_offs(rehearsal), *added), number


def _with_call_offs(rehearsal: Rehearsal) -> Iterator[Task]:
    """Yield the mission's tasks with when they were called off; never, of those that were done."""
    mission, offs = rehearsal.mission, rehearsal.faults.withdrawals
    is_in_steps = mission.source.time == "steps"
    withdrawn = {
        it.task: math.floor(it.at / mission.step) + 1 if is_in_steps else it.at for it in offs
    }
    for key, task in enumerate(mission.source.tasks):
        times = [at for at in (task.cancelled, withdrawn.get(key)) if at is not None]
        is_off = bool(times) and key not in rehearsal.world.done
        yield replace(task, cancelled=min(times) if is_off else None)


def _busy_until(deeds: Sequence[Sequence[Deed]]) -> dict[int, int]:
    """Return the last step in which each robot is shown to have done something."""
    return {
        robot: step
        for step, done in enumerate(deeds, start=1)
        for deed in done
        for robot in deed.robots
    }


def _robots_of(rehearsal: Rehearsal, busy_until: Mapping[int, int]) -> tuple[Robot, ...]:
    """Return the robots, with when each breaks down for good: after what it was busy with."""
    mission, faults = rehearsal.mission, rehearsal.faults
    return tuple(
        replace(
            robot,
            absences=_lost_at(faults, k, mission.step, busy_until.get(k, 0)),
            breaks=None,
            delays=None,
        )
        for k, robot in enumerate(mission.source.robots)
    )


def _lost_at(faults: Faults, robot: int, step: float, busy_until: int) -> tuple[Absence, ...]:
    """Return when a robot breaks down for good, if it does.

    That comes first in a step: who did something in it before, is lost in the next.
    """
    for crash in faults.crashes:
        if crash.robot == robot and crash.back is None:
            return (Absence(max(1 + math.floor(crash.at / step), busy_until + 1)),)
    return ()


class _Teller:
    """Goes through a trace step by step."""

    def __init__(self, mission: Mission, step: float, number: dict[int, int]) -> None:
        robots = range(len(mission.robots))
        self._mission, self._step, self._number = mission, step, number
        self._is_grid = isinstance(mission.world, Grid)
        starts = (Journey((Passed(0.0, mission.robots[r].at),)) for r in robots)
        self._walks = [Walked(0.0, robot, journey) for robot, journey in enumerate(starts)]
        self._says = {robot: (robot, NOBODY) for robot in robots}
        self._shown: set[int] = set()  # tasks whose needs somebody knows
        self._lifted: dict[int, Lifted] = {}  # loads that are up, and no step shows it yet
        self._at_chargers = AtChargers(mission)
        self._at_work: dict[int, tuple[int, ...]] = {}  # by task that is not shown as done

    def tell(
        self,
        writer: SnapshotWriter,
        events: Sequence[Event],
        deeds: Sequence[Sequence[Deed]],
        lost: Mapping[int, int],
        missed: Mapping[int, Collection[int]],
    ) -> None:
        """Write down each step; `deeds` has what it shows as done, `lost` who is lost when.

        `missed` are the tasks that are missed in a step.
        """
        position = 0
        for step, done in enumerate(deeds, start=1):
            heard, lifts = set[tuple[int, int, str]](), list[Lifted]()
            shown, moved, found = set[int](), dict[int, TaskAt](), list[int]()
            while position < len(events) and events[position].at <= step * self._step + SLACK:
                event = events[position]
                position += 1
                self._at_chargers.note(event)
                if isinstance(event, Walked):
                    self._walks[event.robot] = event
                elif isinstance(event, Said) and event.robot in self._says:
                    self._says[event.robot] = (event.team, event.goal)
                elif isinstance(event, Sent) and event.kind in HEARD:
                    heard.add((event.sender, event.receiver, event.kind))
                elif isinstance(event, Lifted):
                    lifts.append(event)
                elif isinstance(event, OfWorld) and event.task in self._number:
                    self._note_service(event)
                elif isinstance(event, Believed):
                    moved[event.task] = TaskAt(event.task, *self._as_place(*event.place))
                    found += [event.task] if event.is_found else []
                elif isinstance(event, Noticed) and event.what == NEEDS:
                    shown.add(event.task)
            gone = tuple(r for r, at in lost.items() if at == step)
            seen = self._seen(step * self._step, gone, done, lifts)
            places = {robot: at for robot, (_, at) in seen.said.items()}
            seen = replace(seen, charge=self._at_chargers.of(places))
            new, self._shown = tuple(sorted(shown - self._shown)), self._shown | shown
            seen = replace(seen, shown=new, found=tuple(found), moved=tuple(moved.values()))
            seen = replace(seen, missed=tuple(sorted(missed.get(step, ()))))
            writer.add(self._mission, replace(seen, heard=tuple(sorted(heard))))

    def _seen(
        self, now: float, lost: tuple[int, ...], done: Sequence[Deed], lifts: Sequence[Lifted]
    ) -> Sighting:
        for robot in lost:
            del self._says[robot]
        lifted, left = self._loads(lifts, done)
        return Sighting(
            said={
                robot: (team, self._as_place(*self._place(self._walks[robot], now)))
                for robot, (team, _) in self._says.items()
            },
            aims={robot: self._number.get(goal) for robot, (_, goal) in self._says.items()},
            at_work=dict(self._at_work),
            done=done,
            taken=[Deed(k, self._as_place(*it.place), it.robots) for k, it in lifted.items()],
            left=tuple(left.values()),
            lost=lost,
        )

    def _note_service(self, event: OfWorld) -> None:
        """Note that a service begins, or breaks off."""
        if event.kind == "serve":
            self._at_work[self._number[event.task]] = event.robots
        elif event.kind == "broken":
            self._at_work.pop(self._number[event.task], None)

    def _loads(
        self, lifts: Sequence[Lifted], done: Sequence[Deed]
    ) -> tuple[dict[int, Lifted], dict[int, TaskAt]]:
        """Return the loads that a step shows as taken up, and those that it shows as set down.

        One that was taken up and set down, or brought, before any step showed it is shown as that.
        """
        left = dict[int, TaskAt]()
        for lift in lifts:
            number = self._number[lift.task]
            if lift.robots:
                self._lifted[number] = lift
            else:
                self._lifted.pop(number, None)
                left[number] = TaskAt(number, *self._as_place(*lift.place))
        for deed in done:
            self._lifted.pop(deed.task, None)
        busy = {robot for deed in done for robot in deed.robots}
        taken = {k: lift for k, lift in self._lifted.items() if busy.isdisjoint(lift.robots)}
        self._lifted = {k: lift for k, lift in self._lifted.items() if k not in taken}
        return taken, left

    def _as_place(self, x: float, y: float) -> Place:
        return (int(x), int(y)) if self._is_grid else (round(x, DECIMALS), round(y, DECIMALS))

    def _place(self, walk: Walked, now: float) -> Place:
        return self._as_place(*walk.journey.place(now, self._mission.world))
