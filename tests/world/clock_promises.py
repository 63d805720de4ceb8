"""What every log of events keeps, whatever was planned: a second reading of the rules."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Sequence
from itertools import pairwise

import numpy as np

from teamformer.mission.checks.windows import release_of
from teamformer.mission.model import Mission, Robot
from teamformer.mission.parts.capabilities import covers, total
from teamformer.mission.parts.grid import Grid, Place
from teamformer.mission.parts.plane import Plane
from teamformer.mission.parts.roads import Roads
from teamformer.world.continuous.events import KINDS, Event
from teamformer.world.reference.ways import PlainWays
from teamformer.world.rules.constants import NOBODY

NEAR = 1e-6


def length_of(mission: Mission, robot: int, here: Place, there: Place) -> float:
    """Return how long a robot takes from one place to another, by a second working out."""
    real, world = mission.robots[robot], mission.world
    if isinstance(world, Roads):
        times = np.array(world.times[real.moves])
        direct = times[int(here[0]), int(there[0])]
        if not math.isfinite(direct):
            direct = world.ways[real.moves][int(here[0])][int(there[0])]
        return float(direct) / real.speed
    if isinstance(world, Plane):
        return math.dist(here, there) / real.speed
    assert isinstance(world, Grid)
    return PlainWays(world).length(here, there, real.flies) / real.speed


def check_promises(mission: Mission, truth: Mission, events: Sequence[Event]) -> None:
    """Check a whole log: fields, order, causes, walks, teams, needs, releases, times."""
    for number, event in enumerate(events):
        kind = KINDS[event.kind]
        assert number == 0 or events[number - 1].at <= event.at, "time goes on"
        assert event.cause < number, f"a cause is earlier: {event}"
        for field in kind.fields:
            lacks = getattr(event, field) in ((), None, NOBODY, "")
            assert not lacks or field in kind.may_lack, f"{event.kind} says its {field}: {event}"
    _check_causes(truth, events)
    _check_walks(truth, events)
    _check_services(truth, events)
    _check_zones(mission, events)
    if events[-1].kind == "over" and events[-1].status == "completed":
        assert path_length(events) <= events[-1].at + NEAR


def _check_causes(truth: Mission, events: Sequence[Event]) -> None:
    """Check that what begins begins at its cause, and what goes on takes the time that it says."""
    begins = {"walk", "form", "serve", "plan", "know", "broken"}
    for event in events:
        if event.cause == NOBODY:
            continue
        cause = events[event.cause]
        if event.kind in begins and cause.kind != "opens":
            is_idle = event.plan is not None and "idle" in event.plan.reasons
            is_loose = event.kind == "serve" or is_idle
            assert cause.at == event.at or is_loose, f"{event} hangs on {cause}"
        if event.kind in ("formed", "unload") or (event.kind == "arrive" and cause.kind == "walk"):
            assert cause.until is not None
            assert abs(cause.until - event.at) < NEAR, f"{event} comes when {cause} says"


def _check_walks(truth: Mission, events: Sequence[Event]) -> None:
    """Check that robots are where they set out from, and take the time that their ways take."""
    has_delays = any(robot.delays for robot in truth.robots)
    for event in events:
        if event.kind != "walk":
            continue
        [robot] = event.robots
        way = event.way
        assert way[-1].at == event.until
        assert way[0].at <= event.at + NEAR
        assert all(a.at <= b.at for a, b in pairwise(way))
        if has_delays or len(way) < 2:
            continue
        ahead = [passed for passed in way if passed.at >= event.at - NEAR]
        takes = length_of(truth, robot, ahead[0].place, way[-1].place)
        walked = _worked(truth.robots[robot], ahead[0].at, way[-1].at)
        assert abs(walked - takes) < NEAR, f"as long as the way: {event}"


def _shifts_of(robot: Robot, until: float) -> list[tuple[float, float]]:
    """Return when a robot works up to a time, turn by turn."""
    if not robot.shifts:
        return [(0.0, math.inf)]
    turns = range(1 + (int(until / robot.every) if robot.every else 0))
    return [(a + n * robot.every, b + n * robot.every) for n in turns for a, b in robot.shifts]


def _worked(robot: Robot, begin: float, end: float) -> float:
    """Return how long a robot works between two times."""
    shifts = _shifts_of(robot, end)
    return sum(max(0.0, min(end, closes) - max(begin, opens)) for opens, closes in shifts)


def _check_services(truth: Mission, events: Sequence[Event]) -> None:
    """Check teams, needs, releases, precedence, forming and durations, from events alone."""
    at: dict[int, Place] = {number: robot.at for number, robot in enumerate(truth.robots)}
    over: dict[int, float] = {}
    known = {number for number, task in enumerate(truth.tasks) if task.appears == 0}
    serving: dict[int, Event] = {}
    busy: dict[int, int] = {}
    lost: set[int] = set()
    lies: dict[int, Place] = {}
    names = {task.name: number for number, task in enumerate(truth.tasks)}
    for event in events:
        task = event.task
        if event.kind in ("walk", "form", "serve"):
            assert not lost.intersection(event.robots), f"nobody lost does anything: {event}"
            assert not busy.keys() & set(event.robots), f"who is at work does nothing else: {event}"
        if event.kind == "arrive":
            at[event.robots[0]] = event.place  # type: ignore[assignment]
        elif event.kind == "appear":
            known.add(task)
        elif event.kind == "form":
            busy |= dict.fromkeys(event.robots, task)
        elif event.kind == "formed":
            _release(busy, event.robots)
        elif event.kind == "serve":
            real = truth.tasks[task]
            place = lies.get(task, real.at)
            assert task in known, f"nobody serves what is not known: {event}"
            assert task not in over, f"nobody serves what is over: {event}"
            assert covers(total(truth.robots[r].can for r in event.robots), real.needs)
            assert all(_is_same(at[r], place) for r in event.robots), f"all are there: {event} {at}"
            assert release_of(real) <= event.at + NEAR
            for shifts in (_shifts_of(truth.robots[r], event.until or 0.0) for r in event.robots):
                is_in_one = [a <= event.at and (event.until or 0.0) <= b + NEAR for a, b in shifts]
                assert any(is_in_one), f"it fits into a shift of each: {event}"
            assert all(over.get(names[name], math.inf) <= event.at for name in real.after)
            assert task not in serving
            serving[task] = event
            busy |= dict.fromkeys(event.robots, task)
        elif event.kind == "done":
            begun = serving.pop(task)
            real = truth.tasks[task]
            least = real.duration + real.unload
            assert event.at - begun.at >= least - NEAR, f"it takes as long as it takes: {event}"
            if real.to is None:
                assert event.at - begun.at <= least + NEAR
            over[task] = event.at
            _release(busy, event.robots)
            at |= dict.fromkeys(event.robots, event.place)  # type: ignore[arg-type]
        elif event.kind == "broken":
            serving.pop(task, None)
            _release(busy, event.robots)
            if event.place is not None:
                lies[task] = event.place
            for robot in event.robots:
                if event.place is not None:
                    at[robot] = event.place
        elif event.kind == "cancel":
            over[task] = event.at
        elif event.kind == "lost":
            lost.add(event.robots[0])
            _release(busy, event.robots)
            at[event.robots[0]] = event.place  # type: ignore[assignment]
        elif event.kind == "back":
            lost.discard(event.robots[0])
    if events[-1].status == "completed":
        missed = set(range(len(truth.tasks))) - over.keys()
        assert all(truth.tasks[task].optional for task in missed), "what must be done is done"


def _check_zones(mission: Mission, events: Sequence[Event]) -> None:
    """Check that no more services go on at once in a zone than there is room for."""
    for zone in mission.zones:
        places, under_way = {k: task.at for k, task in enumerate(mission.tasks)}, set[int]()
        loads = set(zone.loads_in(mission.tasks))
        for event in events:
            is_served = event.kind == "serve" and zone.has(
                mission.tasks[event.task], places[event.task]
            )
            if is_served or (event.kind == "unload" and event.task in loads):
                under_way.add(event.task)
            elif event.kind in ("done", "broken", "lift"):
                under_way.discard(event.task)
            if event.kind == "broken" and event.place is not None:
                places[event.task] = event.place
            assert len(under_way) <= zone.room, f"{zone.name} has no room for {event}"


def _is_same(one: Place, other: Place) -> bool:
    return math.dist(one, other) < NEAR


def _release(busy: dict[int, int], robots: Iterable[int]) -> None:
    for robot in robots:
        busy.pop(robot, None)


def path_length(events: Sequence[Event]) -> float:
    """Return the sum of the stretches along the causes of the end."""
    number, length = len(events) - 1, 0.0
    while events[number].cause != NOBODY:
        before = events[number].cause
        length += events[number].at - events[before].at
        number = before
    return length + events[number].at


def waits_of(events: Sequence[Event]) -> dict[str, int]:
    """Return how many events there are of each kind."""
    counts: defaultdict[str, int] = defaultdict(int)
    for event in events:
        counts[event.kind] += 1
    return dict(counts)
