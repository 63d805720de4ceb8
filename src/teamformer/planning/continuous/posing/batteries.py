"""Batteries and chargers of a mission in continuous time, for searches and for the clock."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from teamformer.base.array_types import Int32s, Ints
from teamformer.mission.coordination import Known
from teamformer.mission.model import Mission
from teamformer.mission.parts.charging import has_batteries
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.zones import has_loads_at_zones
from teamformer.planning.continuous.posing.tables import distances
from teamformer.planning.problem.batteries import ENDLESS, Batteries, with_permits
from teamformer.planning.problem.coalition_problem import NEVER, CoalitionProblem, different_rows
from teamformer.world.rules.charging.standing import charge_rules, home_of, stand_charged
from teamformer.world.rules.charging.stops import ChargeRules
from teamformer.world.rules.charging.times import ChargedTimes, ChargeStart, time_charged
from teamformer.world.rules.starts import StartRules


class ChargedClock(NamedTuple):
    """What it takes to time a plan whose robots charge, by the mission's own rules and ways."""

    charging: ChargeRules
    standing: ChargeStart

    def time(
        self, rules: StartRules, order: Sequence[int], robots_of: Mapping[int, Sequence[int]]
    ) -> ChargedTimes:
        """Return when tasks start that are done in an order, each by its robots."""
        return time_charged(rules, self.charging, self.standing, order, robots_of)


def charged_clock(
    known: Known, numbers: Sequence[int], chosen: Sequence[int]
) -> ChargedClock | None:
    """Return the clock of some robots and tasks, by number; None if nobody ever queues.

    Robots with batteries queue at chargers, teams with loads before zones.
    """
    mission = known.mission
    robots = [mission.robots[robot] for robot in numbers]
    if not has_batteries(robots) and not has_loads_at_zones(mission):
        return None
    tasks = [mission.tasks[task] for task in chosen]
    chargers = [charger.at for charger in mission.chargers]
    starts = [known.places[robot] for robot in numbers]
    homes = [home_of(mission, robot) for robot in numbers]
    ends = [home for home in homes if home is not None]
    goals = [place for task in tasks for place in (task.at, task.ends_at)]
    places = list(dict.fromkeys([*goals, *starts, *chargers, *ends]))
    number_of: dict[Hashable, int] = {place: number for number, place in enumerate(places)}
    movers = {robot.moves for robot in robots}
    lengths = {moves: distances(mission.world, moves, places, places) for moves in movers}

    def way(robot: int, here: Hashable, there: Hashable) -> float:
        if here == there:
            return 0.0
        far = lengths[robots[robot].moves][number_of[here], number_of[there]]
        return float(far) / robots[robot].speed

    rules = charge_rules(mission, way)
    rules = replace(rules, batteries=[robot.battery for robot in robots])
    return ChargedClock(rules, stand_charged(known, numbers, chosen))


def by_ability(
    mission: Mission,
    numbers: Sequence[int],
    chosen: Sequence[int],
    counts: Int32s,
    needs: Int32s,
) -> tuple[Int32s, Int32s]:
    """Return counts (robots, caps) and needs (tasks, caps) that only able robots can meet.

    What is needed of a task that some robots are not able for is needed of those that are: that is
    a capability of its own. An optional task that those who are able cannot do needs nothing: a
    task without robots is left out.
    """
    charging = mission.charging
    if charging is None:
        return counts, needs
    is_able = np.array([[charging.is_able(robot, task) for task in chosen] for robot in numbers])
    is_optional = np.array([mission.tasks[task].optional for task in chosen])
    more_counts, more_needs = [counts], [needs.copy()]
    for able in np.unique(is_able.T, axis=0):
        if able.all():
            continue
        alike = (is_able == able[:, None]).all(axis=0)
        own = np.where(alike[:, None], needs, 0)
        more_needs[0] -= own
        own[is_optional & (own > counts[able].sum(axis=0)).any(axis=1)] = 0
        more_needs.append(own)
        more_counts.append(counts * able[:, None])
    return np.hstack(more_counts).astype(np.int32), np.hstack(more_needs).astype(np.int32)


def kinds_apart(known: Known, numbers: Sequence[int], apart: Sequence[int]) -> Sequence[int]:
    """Return numbers that tell robots apart that are, and those with different batteries."""
    batteries = [known.mission.robots[robot].battery for robot in numbers]
    if not any(batteries):
        return apart
    homes = [home_of(known.mission, robot) or (-1.0, -1.0) for robot in numbers]
    rows = [
        (own, *home, *((-1.0,) * 4 if b is None else (b.lasts, b.fills, b.serving, b.waiting)))
        for own, home, b in zip(apart, homes, batteries, strict=True)
    ]
    number: list[int] = different_rows(np.array(rows))[1].tolist()
    return number


def batteries_of(
    clock: ChargedClock,
    problem: CoalitionProblem,
    places: Sequence[Place],
    now: float,
    ticks: Callable[[npt.ArrayLike], Ints],
) -> Batteries:
    """Return the batteries of a problem in ticks, whose places these are: where robots come from.

    Those of tasks are where these end.
    """
    charging, standing = clock.charging, clock.standing
    first, pace = problem.like[:, 0].tolist(), problem.pace[: problem.bodies]
    kinds = [robot for robot in first if robot < problem.bodies]
    of_pace = [int(np.flatnonzero(pace == one)[0]) for one in range(1 + int(pace.max()))]
    chargers = charging.chargers
    tasks = [standing.task_places[task] for task in range(len(problem.needs))]
    own = [charging.batteries[robot] for robot in kinds]

    def ways(robots: Sequence[int], froms: Sequence[Hashable], tos: Sequence[Hashable]) -> Ints:
        rows = [[[charging.way(r, a, b) for b in tos] for a in froms] for r in robots]
        return ticks(np.array(rows).reshape(len(robots), len(froms), len(tos)))

    def length(robot: int, here: Hashable, goal: Hashable | None) -> float:
        return 0.0 if goal is None else charging.way(robot, here, goal)

    def onward(robot: int, goal: Hashable | None, wanted: float) -> list[float]:
        if goal is None or charging.batteries[robot] is None:
            return [0.0 for _ in chargers]
        return charging.from_chargers(robot, goal, wanted)

    fro, to_goals = [], []
    for robot in kinds:
        goals = [*tasks, standing.homes[robot]]
        wanted = [
            charging.wanted(robot, spent, standing.task_ends[task])
            for task, spent in enumerate(standing.spends[robot])
        ]
        to_goals.append([onward(robot, *pair) for pair in zip(goals, [*wanted, 0.0], strict=True)])
        fro.append([[length(robot, charger, goal) for goal in goals] for charger in chargers])
    to = ways(of_pace, places, chargers)
    onwards = np.array(to_goals).transpose(0, 2, 1)  # (kinds, chargers, goals)
    left = [ENDLESS if np.isinf(one) else int(ticks(one)) for one in standing.left]
    taken = [(charger, int(ticks(until - now))) for charger, until in standing.taken]
    batteries = Batteries(
        lasts=np.array([ENDLESS if b is None else int(ticks(b.lasts)) for b in own], np.int64),
        fills=np.array([0.0 if b is None else b.fills / b.lasts for b in own]),
        waiting=np.array([0.0 if b is None else b.waiting for b in own]),
        spends=ticks([standing.spends[robot] for robot in kinds]),
        serves=ticks([standing.serves[robot] for robot in kinds]),
        services=np.maximum(1, ticks(standing.services)),
        left=np.array(left, np.int64),
        to=to,
        nearest=to.min(axis=2),
        fro=ticks(fro),
        between=ways(of_pace, chargers, chargers),
        onward=np.ascontiguousarray(np.where(np.isfinite(onwards), ticks(onwards), NEVER)),
        room=np.array(charging.rooms, np.int64),
        taken=np.array(taken, np.int64).reshape(-1, 2),
    )
    permits = len(problem.counts) - problem.bodies
    more = len(first) - len(kinds), problem.ways.shape[1] - len(places)
    return with_permits(batteries, permits, *more)
