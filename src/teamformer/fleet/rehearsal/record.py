"""Turns the trace of a rehearsal into a record that `view` shows: one step of it a step of time.

Robots that say they are in one team, and are in one place, are drawn as a team. Those that did a
task, or took up a load, are drawn as a team where they did to the end of the step, though they may
have gone on. If some of them did another task with others in the same step, that is drawn in the
next; so is a load that they took up then. Operators' tasks are tasks that appear.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from teamformer.fleet.bodies.world import Lifted, Walked
from teamformer.fleet.rehearsal.faults import Faults
from teamformer.fleet.rehearsal.outcome import Outcome
from teamformer.fleet.rehearsal.play import Rehearsal
from teamformer.fleet.rehearsal.services_seen import with_services
from teamformer.fleet.rehearsal.trace import NEEDS, Believed, Event, Finished, Noticed, Said, Sent
from teamformer.mission.model import Absence, Mission, Robot, Task
from teamformer.mission.parts.grid import Grid, Place
from teamformer.mission.parts.plane import DECIMALS
from teamformer.record.record import FLEET, HEARD, Ending, Record, Step, TaskAt, TeamAt
from teamformer.world.rules.constants import NOBODY

Teams = dict[int, tuple[int, ...]]
"""The robots of each team, by its lowest."""


@dataclass(frozen=True)
class Deed:
    """A task that was done in a step, or whose load was taken up, where, and by which robots."""

    task: int
    at: Place
    robots: tuple[int, ...]


SLACK = 1e-9
"""By how many seconds something may come after the end of a step and still be of that step."""

STATUSES = {"ended": "completed", "infeasible": "infeasible", "blocked": "step limit"}


def record_of(rehearsal: Rehearsal, outcome: Outcome, events: Sequence[Event], seed: int) -> Record:
    """Return the record of a rehearsal that has been played."""
    mission = rehearsal.mission
    events = sorted(events, key=lambda event: event.at)
    tasks, number = _tasks_of(rehearsal)
    done = rehearsal.world.done.values()
    truth = _truth_of(rehearsal, tasks)
    by_key = {it.key: deed_of(number[it.key], truth, it.robots) for it in done}
    deeds = deeds_by_step(events, by_key, mission.step)
    deeds += [[] for _ in range(len(deeds), math.ceil(outcome.end / mission.step))]
    robots = _robots_of(rehearsal, deeds)
    source = replace(mission.source, tasks=tasks, robots=robots, teams=())
    true_mission = replace(source, tasks=truth)
    ends = ((robot, at.lost_for_good) for robot, at in enumerate(robots))
    lost = {robot: step for robot, step in ends if step is not None}
    rows = with_services(
        true_mission, _Teller(source, mission.step, number).tell(events, deeds, lost)
    )
    is_complete, steps = outcome.status == "ended", len(rows)
    return Record(
        mission=source,
        method=FLEET,
        seed=seed,
        orders=((0, tuple(k for k, task in enumerate(source.tasks) if task.appears == 0)),),
        start=tuple((robot, (robot,), *at.at) for robot, at in enumerate(source.robots)),
        steps=tuple(rows),
        truth=true_mission if source.has_surprises else None,
        end=Ending(
            status=STATUSES[outcome.status],
            makespan=steps if is_complete else None,
            steps=steps,
            tasks_done=outcome.tasks_done,
            joins=sum(len(row.joins) for row in rows),
            splits=sum(len(row.splits) for row in rows),
            illegal_decisions=0,
            blocked_tasks=outcome.blocked_tasks,
        ),
    )


def _truth_of(rehearsal: Rehearsal, tasks: Sequence[Task]) -> tuple[Task, ...]:
    """Return the tasks as they really were; operators' are as they said."""
    own = zip(tasks, rehearsal.truth.tasks, strict=False)
    known = (task.once_known(true.at, true.needs, true.duration) for task, true in own)
    return (*known, *tasks[len(rehearsal.truth.tasks) :])


def deed_of(number: int, tasks: Sequence[Task], robots: tuple[int, ...]) -> Deed:
    """Return that a task was done: a load, where it was brought."""
    task = tasks[number]
    return Deed(number, task.at if task.to is None else task.to, robots)


def _tasks_of(rehearsal: Rehearsal) -> tuple[tuple[Task, ...], dict[int, int]]:
    """Return the tasks with those that operators added, and the number of each by its key."""
    mission, whole = rehearsal.mission, rehearsal.mission.source
    orders = [it for it in rehearsal.faults.orders if it.task.key in rehearsal.world.tasks]
    is_grid = isinstance(whole.world, Grid)
    added = [
        Task(
            order.task.name,
            (int(order.task.x), int(order.task.y)) if is_grid else (order.task.x, order.task.y),
            {
                cap: need
                for cap, need in zip(whole.capabilities, order.task.needs, strict=True)
                if need
            },
            round(order.task.duration / mission.step),
            math.ceil(order.at / mission.step),
        )
        for order in orders
    ]
    number = {task.key: task.key for task in mission.tasks}
    number |= {order.task.key: len(mission.tasks) + k for k, order in enumerate(orders)}
    return (*_with_call_offs(rehearsal), *added), number


def _with_call_offs(rehearsal: Rehearsal) -> Iterator[Task]:
    """Yield the mission's tasks with when they were called off; never, of those that were done."""
    mission = rehearsal.mission
    withdrawn = {
        it.task: math.floor(it.at / mission.step) + 1 for it in rehearsal.faults.withdrawals
    }
    for key, task in enumerate(mission.source.tasks):
        times = [at for at in (task.cancelled, withdrawn.get(key)) if at is not None]
        is_off = bool(times) and key not in rehearsal.world.done
        yield replace(task, cancelled=min(times) if is_off else None)


def _robots_of(rehearsal: Rehearsal, deeds: Sequence[Sequence[Deed]]) -> tuple[Robot, ...]:
    """Return the robots, with when each breaks down for good; `deeds` are those of each step."""
    busy_until = {
        robot: step
        for step, done in enumerate(deeds, start=1)
        for deed in done
        for robot in deed.robots
    }
    mission, faults = rehearsal.mission, rehearsal.faults
    return tuple(
        replace(robot, absences=_lost_at(faults, k, mission.step, busy_until.get(k, 0)))
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
        self._step, self._number = step, number
        self._is_grid = isinstance(mission.world, Grid)
        self._walks = [Walked(0.0, r, (mission.robots[r].at,), 0.0, 1.0) for r in robots]
        self._says = {robot: (robot, NOBODY) for robot in robots}
        self._teams: Teams = {robot: (robot,) for robot in robots}
        self._shown: dict[int, TeamAt] = {}
        self._seen: set[int] = set()  # tasks whose needs somebody knows
        self._lifted: dict[int, Lifted] = {}  # loads that are up, and no step shows it yet

    def tell(
        self, events: Sequence[Event], deeds: Sequence[Sequence[Deed]], lost: Mapping[int, int]
    ) -> list[Step]:
        """Return what changed in each step; `deeds` has what each shows as done."""
        rows, position = [], 0
        for step, done in enumerate(deeds, start=1):
            heard, lifts, shown = set(), list[Lifted](), set[int]()
            moved, found = dict[int, TaskAt](), list[int]()
            while position < len(events) and events[position].at <= step * self._step + SLACK:
                event = events[position]
                position += 1
                if isinstance(event, Walked):
                    self._walks[event.robot] = event
                elif isinstance(event, Said):
                    self._says[event.robot] = (event.team, event.goal)
                elif isinstance(event, Sent) and event.kind in HEARD:
                    heard.add((event.sender, event.receiver, event.kind))
                elif isinstance(event, Lifted):
                    lifts.append(event)
                elif isinstance(event, Believed):
                    moved[event.task] = TaskAt(event.task, *self._as_place(*event.place))
                    found += [event.task] if event.is_found else []
                elif isinstance(event, Noticed) and event.what == NEEDS:
                    shown.add(event.task)
            row = self._row(step, [r for r, at in lost.items() if at == step], done, lifts)
            new, self._seen = tuple(sorted(shown - self._seen)), self._seen | shown
            rows.append(
                replace(
                    row,
                    heard=tuple(sorted(heard)),
                    shown=new,
                    found=tuple(found),
                    moved=tuple(moved.values()),
                )
            )
        return rows

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

    def _row(
        self, step: int, lost: list[int], done: Sequence[Deed], lifts: Sequence[Lifted]
    ) -> Step:
        now = step * self._step
        for robot in lost:
            del self._says[robot]
        lifted, left = self._loads(lifts, done)
        said = {
            robot: (team, self._as_place(*self._place(self._walks[robot], now)))
            for robot, (team, _) in self._says.items()
        }
        taking = [Deed(k, self._as_place(*it.place), it.robots) for k, it in lifted.items()]
        places, teams, doers = teams_shown(said, done, taking)
        splits, joins = team_changes(self._teams, teams, lost)
        self._teams = teams
        slot_of = {robot: slot for slot, robots in teams.items() for robot in robots}
        taken = {
            load: slot_of[lift.robots[0]]
            for load, lift in lifted.items()
            if lift.robots[0] in slot_of
        }
        goals = doers_goals(doers, taken)
        shown = {}
        for slot in sorted(teams):
            goal = goals.get(slot, self._number.get(self._says[slot][1]))
            shown[slot] = TeamAt(slot, *places[slot], goal)
        rows = tuple(at for slot, at in shown.items() if self._shown.get(slot) != at)
        self._shown = shown
        finished = tuple((deed.task, who_did(deed, teams)) for deed in done)
        made = Step(joins, splits, tuple(lost), teams=rows, done=finished)
        return replace(made, taken=tuple(taken.items()), left=tuple(left.values()))

    def _as_place(self, x: float, y: float) -> Place:
        return (int(x), int(y)) if self._is_grid else (round(x, DECIMALS), round(y, DECIMALS))

    def _place(self, walk: Walked, now: float) -> Place:
        if len(walk.points) == 1:
            return walk.points[0]
        passed = min((now - walk.begin) / walk.time + 1e-6, len(walk.points) - 1)
        at = min(int(max(0.0, passed)), len(walk.points) - 2)
        (x, y), (to_x, to_y) = walk.points[at], walk.points[at + 1]
        part = passed - at
        if self._is_grid:
            return (to_x, to_y) if part >= 1 else (x, y)
        return round(x + part * (to_x - x), DECIMALS), round(y + part * (to_y - y), DECIMALS)


def deeds_by_step(
    events: Iterable[Event], deeds: Mapping[int, Deed], step: float
) -> list[list[Deed]]:
    """Return what each step shows as done, from the first step to the last that shows anything.

    `events` are in order of time, `deeds` by the key of their task.
    """
    finished = deque(event for event in events if isinstance(event, Finished))
    rows = list[list[Deed]]()
    waiting = list[Deed]()
    while finished or waiting:
        while finished and finished[0].at <= (len(rows) + 1) * step + SLACK:
            waiting.append(deeds[finished.popleft().task])
        done, waiting = _at_once(waiting)
        rows.append(done)
    return rows


def _at_once(deeds: Sequence[Deed]) -> tuple[list[Deed], list[Deed]]:
    """Return the deeds that one step can show, and those that come in the next.

    A robot is in one team in a step: what it did with others than before waits for the next.
    """
    now, later = list[Deed](), list[Deed]()
    for deed in deeds:
        robots = set(deed.robots)
        is_clear = all(
            robots == set(other.robots) or robots.isdisjoint(other.robots)
            for other in (*now, *later)
        )
        (now if is_clear else later).append(deed)
    return now, later


def teams_shown(
    said: Mapping[int, tuple[int, Place]], done: Sequence[Deed], taking: Sequence[Deed] = ()
) -> tuple[dict[int, Place], Teams, set[int]]:
    """Return places by robot, teams, and the slots of teams that have just done something.

    `said` has each robot's team by its word, and its place; `taking` are the loads taken up. Who
    has done several tasks in a step is where it did the last.
    """
    did = {robot: deed for deed in (*taking, *done) for robot in deed.robots if robot in said}
    groups: dict[tuple[int, int, Place], list[int]] = {}
    places = {}
    for robot, (team, place) in sorted(said.items()):
        deed = did.get(robot)
        places[robot] = place if deed is None else deed.at
        key = (-1, team, place) if deed is None else (deed.task, 0, deed.at)
        groups.setdefault(key, []).append(robot)
    teams = {robots[0]: tuple(robots) for robots in groups.values()}
    return places, teams, {slot for slot in teams if did.get(slot) in done}


def doers_goals(doers: Iterable[int], taken: Mapping[int, int]) -> dict[int, int | None]:
    """Return what teams are shown to head for: those that have just done something for nothing.

    Who has taken up a load heads for that; `taken` has the team by the load.
    """
    nothing: dict[int, int | None] = dict.fromkeys(doers)
    return nothing | {slot: load for load, slot in taken.items()}


def who_did(deed: Deed, teams: Teams) -> int:
    """Return the team to show as the one that did a task: that with most of those who did it."""
    return max(
        sorted(teams),
        key=lambda slot: len(set(teams[slot]) & set(deed.robots)),
        default=0,
    )


def team_changes(
    before: Teams, after: Teams, lost: Sequence[int]
) -> tuple[
    tuple[tuple[tuple[int, ...], tuple[int, ...]], ...],
    tuple[tuple[int, int], ...],
]:
    """Return the splits, then the joins, that make one set of teams of another.

    Robots that are lost then, which comes after both in a step, part from the others before.
    """
    splits, pieces = [], []
    after = after | {robot: (robot,) for robot in lost}
    for robots in before.values():
        parts = [tuple(r for r in robots if r in team) for team in after.values()]
        parts = sorted(part for part in parts if part)
        pieces += parts
        rest = robots
        for part in parts[:-1]:
            rest = tuple(robot for robot in rest if robot not in part)
            splits.append((part, rest))
    joins = []
    for slot, team in sorted(after.items()):
        joins += [(min(piece), slot) for piece in sorted(pieces) if slot < min(piece) in team]
    return tuple(splits), tuple(joins)
