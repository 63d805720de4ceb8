"""Random missions with batteries, and what runs them."""

from __future__ import annotations

import random

from teamformer.base.errors import MissionError
from teamformer.mission.coordination import Known, Plan
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.charging import Battery, Charger
from teamformer.mission.parts.grid import Grid
from teamformer.mission.parts.plane import Plane
from teamformer.planning.continuous.present import plan_present
from teamformer.world.continuous.course import Course


class Planned:
    """A coordinator that plans as `plan` does."""

    def update(self, known: Known, plan: Plan | None) -> Plan:
        return plan_present(known, plan)


class Given:
    """A coordinator with a plan that it keeps, as far as robots are there."""

    def __init__(self, plan: Plan) -> None:
        self.plan = plan

    def update(self, known: Known, plan: Plan | None) -> Plan:
        there, open_tasks = set(known.robots), set(known.open_tasks)
        rows = zip(self.plan.order, self.plan.coalitions, strict=True)
        kept = [row for row in rows if row[0] in open_tasks and there.issuperset(row[1])]
        return Plan(tuple(task for task, _ in kept), tuple(robots for _, robots in kept))


def charged_mission(
    seed: int, robots: int = 4, tasks: int = 6, side: int = 50, lasts: float = 80, room: int = 1
) -> Mission:
    """Draw a mission that can be done: on a grid or a plane, with four chargers or one."""
    rng = random.Random(seed)
    while True:
        try:
            return _drawn(rng, f"drawn {seed}", robots, tasks, side, lasts, room)
        except MissionError:
            continue


def _drawn(
    rng: random.Random, name: str, robots: int, tasks: int, side: int, lasts: float, room: int
) -> Mission:
    is_grid = rng.random() < 0.5

    def place() -> tuple[float, float]:
        if is_grid:
            return rng.randrange(side), rng.randrange(side)
        return round(rng.uniform(0, side), 3), round(rng.uniform(0, side), 3)

    caps = ("a", "b", "c")
    fleet = [
        Robot(
            f"r{number}",
            place(),
            dict.fromkeys(rng.sample(caps, rng.randint(1, 2)), 1),
            speed=rng.choice([1, 1, 2]),
            battery=Battery(lasts, lasts / 4, rng.choice([1, 0.6]), 0.3, rng.choice([0, 0.1]))
            if rng.random() < 0.8
            else None,
        )
        for number in range(robots)
    ]
    able = sorted({cap for robot in fleet for cap in robot.can})
    wanted = [
        Task(
            f"t{number}",
            place(),
            dict.fromkeys(rng.sample(able, min(len(able), rng.randint(1, 2))), 1),
            duration=rng.randint(5, 15),
            after=(f"t{rng.randrange(number)}",) if number and rng.random() < 0.2 else (),
        )
        for number in range(tasks)
    ]
    quarters = [side // 4, 3 * side // 4]
    chargers = [(x, y) for x in quarters for y in quarters]
    return Mission(
        name,
        Grid(side, side) if is_grid else Plane(side, side),
        caps,
        tuple(fleet),
        tuple(wanted),
        time="continuous",
        ends=rng.choice(["home", None]),
        forming=rng.choice([0.0, 2.0]),
        chargers=tuple(Charger(at, room) for at in chargers[: rng.choice([1, 4])]),
    )


def run_course(mission: Mission, coordinator: Planned | Given) -> Course:
    """Return a course of a mission that has come to its end."""
    course = Course(mission, mission, coordinator)
    course.begin()
    while course.is_running:
        course.go_on()
    return course
