"""The seam to planning: from where the live robots are to who does which task with whom."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from operator import itemgetter
from typing import NamedTuple, Protocol

from teamformer.fleet.charging import FleetCharging
from teamformer.fleet.fleet_mission import FleetMission, place_in
from teamformer.fleet.in_shifts import who_can
from teamformer.fleet.messages import LONGEST, TaskFact, Terms
from teamformer.mission.coordination import UNFORESEEN, Coordinator, Known, Plan
from teamformer.mission.keys.kinds import LARGEST_NUMBER
from teamformer.mission.model import Mission, Task, as_believed
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.roads import Roads
from teamformer.mission.parts.zones import Zone
from teamformer.world.rules.constants import NOBODY

Stop = tuple[int, tuple[int, ...]]
"""A task and its coalition."""


class FleetSituation(NamedTuple):
    """What a plan is made from: the live robots' places, what is to do, who is at work."""

    places: Mapping[int, tuple[float, float]]
    tasks: tuple[TaskFact, ...]
    serving: Mapping[int, tuple[int, ...]] = {}
    old: tuple[Stop, ...] = ()  # the plan before
    age: float = 0.0  # of the mission, seconds
    over: frozenset[int] = frozenset()  # tasks that are done or called off
    seen: frozenset[int] = frozenset()  # uncertain tasks whose needs have been seen
    terms: Mapping[int, Terms] = {}  # what robots have said of their batteries


class FleetPlanner(Protocol):
    """Turns a situation in which every task can be done into stops, in order."""

    def plan(self, mission: FleetMission, situation: FleetSituation) -> Sequence[Stop]:
        """Return tasks with coalitions that can do them, in an order to be kept to.

        Those that it leaves out may be missed.
        """


class CoordinatedPlanner:
    """Has a coordinator plan from what is true now.

    By default that is the shared plan: the one before is among those that its search begins with,
    and stays where what would be gained is small. Where there is one, the search is brief: faults
    come often, and fast.
    """

    def __init__(self, coordinator: Coordinator | None = None) -> None:
        self._coordinator = coordinator
        self._changed: tuple[object, Mission | None] = (None, None)

    def plan(self, mission: FleetMission, situation: FleetSituation) -> Sequence[Stop]:
        """Return the coordinator's plan; tasks that are being served come first, as they are."""
        robots = sorted(situation.places)
        own = len(mission.tasks)
        added = [task for task in situation.tasks if task.key >= own]
        news = [
            task
            for task in situation.tasks
            if task.key >= own or _is_moved(mission, task) or task.key in situation.seen
        ]
        over = frozenset().union(*mission.before.values()) & situation.over
        are_sane = all(_can_get_to(mission, robot, situation.places[robot]) for robot in robots)
        source = self._as_it_is(mission, news, over) if are_sane else None
        if source is None:
            return _one_after_another(mission, situation, robots)
        key_of = [*range(own), *(task.key for task in added)]  # of each task of the source
        number_of = {key: number for number, key in enumerate(key_of)}
        present = _present(mission, situation)
        now, places = present.now, tuple(present.places)
        open_keys, old = frozenset(number_of), _old_plan(situation, number_of)
        known = Known(
            mission=source,
            now=now,
            open_tasks=tuple(number_of[task.key] for task in situation.tasks),
            places=places,
            teams=tuple((robot,) for robot in robots),
            free_at=tuple(present.free_at),
            left=tuple(present.left),
            charging=tuple(present.charging),
            came_from=places,
            unseen_needs=mission.unsure & open_keys - situation.seen,
            news=UNFORESEEN[1:] if situation.old else ("start",),  # nobody tells which it was
        )
        from teamformer.world.guidance.guide import refuse_unfit  # brings numba: most never plan

        plan = self._chosen().update(known, old)
        refuse_unfit(known, plan)
        ends = plan.ends or range(len(plan.order))
        planned = zip(ends, plan.order, plan.coalitions, strict=True)
        in_time = sorted(planned, key=itemgetter(0))  # what is done in passing comes on the way
        stops = [(key_of[task], coalition) for _, task, coalition in in_time if coalition]
        stops += _one_after_another(mission, _without(mission, situation, stops), robots)
        return _serving_first(mission, situation, stops)

    def warm_up(self) -> None:
        """Load what planning needs, so that the first plan has not to wait for it."""
        self._chosen()

    def _chosen(self) -> Coordinator:
        """Return the coordinator; the shared plan is loaded when it is first asked for."""
        if self._coordinator is None:
            from teamformer.methods.coordinators.shared_plan import SharedPlan

            self._coordinator = SharedPlan(scouts=False, is_brief=True)
        return self._coordinator

    def _as_it_is(
        self, mission: FleetMission, news: Sequence[TaskFact], over: frozenset[int]
    ) -> Mission | None:
        """Return the mission as it is believed to be, with operators' tasks at its end.

        Loads are where they lie, tasks need what was seen, and nothing is after what is over. None
        if it could not be run so. The last such mission is kept.
        """
        if not news and not over:
            return mission.believed
        if self._changed[0] != (mission.number, news, over):
            self._changed = (mission.number, news, over), _change(mission, news, over)
        return self._changed[1]


@dataclass
class _Present:
    """How late it is, in the mission's unit, and how everybody stands, by robot."""

    now: float
    places: list[Place]  # where each is, or comes next
    free_at: list[float]
    left: list[float] = field(default_factory=list)  # in batteries, where there are any
    charging: list[tuple[int, float]] = field(default_factory=list)


def _present(mission: FleetMission, situation: FleetSituation) -> _Present:
    """Return how everybody stands as a plan is made."""
    is_in_steps = mission.source.time == "steps"
    now = int(situation.age / mission.step) if is_in_steps else situation.age / mission.step
    places = [robot.at for robot in mission.source.robots]
    present = _Present(now, places, [now] * len(places))
    for robot, at in situation.places.items():
        places[robot] = place_in(mission.source.world, at)
        if isinstance(mission.source.world, Roads):
            present.free_at[robot] = now + at[1] / mission.step
    if mission.charging is not None:
        _note_batteries(mission, mission.charging, situation.terms, present)
    return present


def _note_batteries(
    mission: FleetMission, rules: FleetCharging, said: Mapping[int, Terms], present: _Present
) -> None:
    """Note what all have left, and who charges: who came first to a charger, where there is room.

    Who charges is free when it is full, in steps after the step in which it is.
    """
    terms = {r: said.get(r, Terms(charge=rules.starts(r))) for r in range(mission.robots)}
    there = ((it.charger, it.since, robot) for robot, it in terms.items() if it.since < LONGEST)
    taken = [0] * len(rules.chargers)
    batteries = [robot.battery for robot in mission.believed.robots]
    for robot, battery in enumerate(batteries):
        left = math.inf if battery is None else terms[robot].charge * battery.lasts
        present.left.append(left)
    for charger, _, robot in sorted(there):
        battery = batteries[robot]
        if battery is None or charger == NOBODY or taken[charger] >= rules.rooms[charger]:
            continue
        taken[charger] += 1
        until = present.now + battery.time_to_full(present.left[robot])
        until = math.ceil(until) if mission.source.time == "steps" else until
        present.places[robot], present.free_at[robot] = rules.chargers[charger], until
        present.left[robot] = battery.lasts
        present.charging.append((charger, until))


def _is_moved(mission: FleetMission, task: TaskFact) -> bool:
    """Say whether a mission's task has a load that lies elsewhere than at the beginning."""
    first = mission.tasks[task.key]
    return (task.x, task.y) != (first.x, first.y)


def _can_get_to(mission: FleetMission, robot: int, place: Place) -> bool:
    """Say whether a robot can have got to where it says that it is."""
    start = mission.source.robots[robot].at
    return mission.can_be_at(robot, place) and mission.leads(robot, start, place)


def _old_plan(situation: FleetSituation, number_of: Mapping[int, int]) -> Plan | None:
    """Return what is left of the plan before, in the numbers of the mission."""
    open_keys = {task.key for task in situation.tasks}
    kept = [
        (number_of[key], tuple(robot for robot in coalition if robot in situation.places))
        for key, coalition in situation.old
        if key in open_keys
    ]
    if not kept:
        return None
    order, coalitions = zip(*kept, strict=True)
    return Plan(order, coalitions)


def _change(
    mission: FleetMission, news: Sequence[TaskFact], over: frozenset[int]
) -> Mission | None:
    """Return the mission as it is believed to be; nobody could have planned it so beforehand.

    None if a service takes longer than steps can be counted.
    """
    whole = mission.believed
    caps = whole.capabilities
    names = {whole.tasks[key].name for key in over}
    tasks = [
        replace(task, after=tuple(name for name in task.after if name not in names))
        for task in whole.tasks
    ]
    for task in news:
        if task.key < len(tasks):
            at = place_in(whole.world, (task.x, task.y))
            needs = (
                _named(caps, task.needs)
                if task.key in mission.unsure
                else whole.tasks[task.key].needs
            )
            tasks[task.key] = replace(tasks[task.key], at=at, needs=needs)
    tasks += [
        Task(
            f"added {task.key}",
            place_in(whole.world, (task.x, task.y)),
            _named(caps, task.needs),
            mission.in_time(task.duration),
            optional=mission.may_miss_added,
        )
        for task in news
        if task.key >= len(whole.tasks)
    ]
    if whole.time == "steps" and any(task.duration > LARGEST_NUMBER for task in tasks):
        return None
    zones = _zones_by_name(mission, tasks[len(whole.tasks) :])
    return as_believed(whole, tasks=tuple(tasks), zones=zones)


def _zones_by_name(mission: FleetMission, added: Sequence[Task]) -> tuple[Zone, ...]:
    """Return zones with their tasks by name, so that they hold them wherever loads are brought."""
    own = mission.source.tasks
    held = [
        (zone, [own[k] for k in zone.tasks_in(own)] + [t for t in added if zone.has_place(t.at)])
        for zone in mission.source.zones
    ]
    return tuple(
        Zone(zone.name, tasks=tuple(task.name for task in inside), room=zone.room)
        for zone, inside in held
        if inside
    )


def _named(caps: Sequence[str], needs: Sequence[float]) -> dict[str, float]:
    return {cap: need for cap, need in zip(caps, needs, strict=True) if need}


def _without(
    mission: FleetMission, situation: FleetSituation, stops: Sequence[Stop]
) -> FleetSituation:
    """Return a situation without the tasks that are planned, and those that may be missed."""
    planned = {key for key, _ in stops}
    must = (task for task in situation.tasks if not mission.may_miss(task.key))
    left = tuple(task for task in must if task.key not in planned)
    return situation._replace(tasks=left)


def _serving_first(
    mission: FleetMission, situation: FleetSituation, stops: list[Stop]
) -> list[Stop]:
    """Let who is at work go on; everything else keeps its order."""
    going = {
        task.key: situation.serving[task.key]
        for task in situation.tasks
        if task.key in situation.serving and mission.covers(situation.serving[task.key], task.needs)
    }
    first = list(going.items())
    return first + [stop for stop in stops if stop[0] not in going]


def _one_after_another(
    mission: FleetMission, situation: FleetSituation, robots: Sequence[int]
) -> list[Stop]:
    """Return the plainest plan there is: all robots that can reach a task go, task by task.

    Where they work in shifts, it is those that have a shift for it together.
    """
    if mission.has_shifts:
        return [
            (task.key, who_can(mission, task, situation.places, situation.age))
            for task in situation.tasks
        ]
    return [
        (task.key, tuple(r for r in robots if mission.reach(r, task, situation.places[r])))
        for task in situation.tasks
    ]
