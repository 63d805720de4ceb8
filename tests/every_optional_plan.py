"""Every plan of a small mission in continuous time in which tasks may be left out, timed plainly.

Nothing is shared with the planner. Tasks are put one after another behind those of a plan, each by
every smallest coalition; what cannot end in time goes no further.
"""

from __future__ import annotations

import itertools
import math
from random import Random

from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.plane import Plane

NEAR = 1e-9


def draw_mission(seed: int, tasks: int, share: float, **keys: object) -> Mission:
    """Draw a mission with two to four robots; it is over at a share of what a plan may take."""
    draws = Random(seed)
    side, caps = 100.0, ("a", "b", "c")
    robots = [
        Robot(
            f"r{n}", _place(draws, side), dict.fromkeys(draws.sample(caps, draws.choice((1, 2))), 1)
        )
        for n in range(draws.choice((3, 4)))
    ]
    brought = sorted({cap for robot in robots for cap in robot.can})
    made = [
        Task(
            f"t{n}",
            _place(draws, side),
            dict.fromkeys(draws.sample(brought, min(len(brought), draws.choice((1, 2)))), 1),
            duration=draws.uniform(5, 15),
            optional=n > 0,
            weight=draws.choice((1, 1, 2, 3)),
        )
        for n in range(tasks)
    ]
    return Mission(
        "small",
        Plane(side, side),
        caps,
        tuple(robots),
        tuple(made),
        time="continuous",
        until=round(70 + share * 30 * tasks, 3),
        ends=draws.choice((None, "home")),
        **keys,  # type: ignore[arg-type]
    )


def _place(draws: Random, side: float) -> tuple[float, float]:
    return round(draws.uniform(0, side), 2), round(draws.uniform(0, side), 2)


def best_plan(mission: Mission) -> tuple[float, float]:
    """Return the least that can be missed, by weight, and the least makespan then.

    Infinite if a task that must be done cannot be.
    """
    crews = [_crews(mission, task) for task in mission.tasks]
    start = tuple((0.0, robot.at) for robot in mission.robots)
    best = (math.inf, math.inf)

    def go_on(
        bodies: tuple[tuple[float, tuple[float, float]], ...], ends: dict[int, float]
    ) -> None:
        nonlocal best
        best = min(best, _value(mission, bodies, ends))
        for number, task in enumerate(mission.tasks):
            if number in ends or not all(_number(mission, name) in ends for name in task.after):
                continue
            for crew in crews[number]:
                arrive = [bodies[r][0] + math.dist(bodies[r][1], task.at) for r in crew]
                begin = max(*arrive, *(ends[_number(mission, name)] for name in task.after), 0.0)
                end = max(begin, task.between[0] if task.between else 0.0) + task.duration
                assert mission.until is not None
                if end <= mission.until + NEAR:
                    later = tuple(
                        (end, task.at) if r in crew else body for r, body in enumerate(bodies)
                    )
                    go_on(later, {**ends, number: end})

    go_on(start, {})
    return best


def _number(mission: Mission, name: str) -> int:
    return next(n for n, task in enumerate(mission.tasks) if task.name == name)


def _crews(mission: Mission, task: Task) -> list[tuple[int, ...]]:
    """Return the coalitions that can do a task and of which nobody can be spared."""
    robots = range(len(mission.robots))
    able = [
        crew
        for size in range(1, len(task.needs) + 1)
        for crew in itertools.combinations(robots, size)
        if all(any(cap in mission.robots[r].can for r in crew) for cap in task.needs)
    ]
    return [crew for crew in able if not any(set(other) < set(crew) for other in able)]


def _value(
    mission: Mission,
    bodies: tuple[tuple[float, tuple[float, float]], ...],
    ends: dict[int, float],
) -> tuple[float, float]:
    left = [task for number, task in enumerate(mission.tasks) if number not in ends]
    if not all(task.optional for task in left):
        return math.inf, math.inf
    goes_home = mission.ends == "home"
    back = [
        at + (math.dist(place, robot.at) if goes_home else 0.0)
        for (at, place), robot in zip(bodies, mission.robots, strict=True)
    ]
    makespan = max(back)
    if mission.cost:
        missed = sum(task.weight for task in left)
        total = mission.cost["makespan"] * makespan + mission.cost["missed"] * missed
        return total / sum(mission.cost.values()), makespan
    return sum(task.weight for task in left), makespan
