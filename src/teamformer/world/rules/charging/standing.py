"""How robots with batteries stand at a moment, and by which rules they charge from then on."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence

from teamformer.mission.coordination import Known
from teamformer.mission.keys.mission_keys import HOME
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Place
from teamformer.world.rules.charging.stops import ChargeRules
from teamformer.world.rules.charging.times import ChargeStart


def charge_rules(mission: Mission, way: Callable[[int, Hashable, Hashable], float]) -> ChargeRules:
    """Return the rules by which the robots of a mission charge; `way` is how long they take."""
    return ChargeRules(
        [robot.battery for robot in mission.robots],
        [charger.at for charger in mission.chargers],
        [charger.room for charger in mission.chargers],
        way,
    )


def stand_charged(known: Known, numbers: Sequence[int], chosen: Sequence[int]) -> ChargeStart:
    """Return how some robots stand before some tasks; in their turn they have other numbers.

    Who is not there any more stays where it is.
    """
    mission = known.mission
    robots = [mission.robots[robot] for robot in numbers]
    tasks = [mission.tasks[task] for task in chosen]
    charging, there = mission.charging, set(known.robots)
    carried = [0.0 if charging is None else charging.carried(task) for task in chosen]
    return ChargeStart(
        places=[known.places[robot] for robot in numbers],
        left=[known.left[robot] for robot in numbers],
        taken=known.charging,
        task_places={number: task.at for number, task in enumerate(tasks)},
        task_ends={number: task.ends_at for number, task in enumerate(tasks)},
        homes=[home_of(mission, robot) if robot in there else None for robot in numbers],
        spends=_spent(robots, tasks, carried),
        serves=_spent(robots, tasks, [0.0] * len(tasks)),
        services=[task.duration + task.unload for task in tasks],
    )


def home_of(mission: Mission, robot: int) -> Place | None:
    """Return where a robot is in the end; None if anywhere."""
    if mission.ends is None:
        return None
    ends = mission.robots[robot].at if mission.ends == HOME else mission.ends
    assert not isinstance(ends, str)
    return ends


def _spent(
    robots: Sequence[Robot], tasks: Sequence[Task], carried: Sequence[float]
) -> list[list[float]]:
    """Return what tasks take robots, which carry loads so long."""
    return [
        [
            0.0 if robot.battery is None else robot.battery.spent_on(task, way)
            for task, way in zip(tasks, carried, strict=True)
        ]
        for robot in robots
    ]
