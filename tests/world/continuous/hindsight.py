"""How good plans after news are: runs in which a robot is lost, or tasks appear, beside hindsight.

By hand: `TEAMFORMER_OTHERS=FOLDER python tests/world/continuous/hindsight.py RUNS`. Hindsight is
the plan without the lost robot from the start, or with all tasks known, released as they appear.
"""

from __future__ import annotations

import os
import statistics
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from teamformer.files.imports import import_missions
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.mission.coordination import Known, Plan
from teamformer.mission.model import Absence, Mission, Robot, Task
from teamformer.mission.orders import with_robots
from teamformer.mission.parts.roads import Roads
from teamformer.planning.continuous.continuous_mission import pose_mission
from teamformer.planning.continuous.rules import plan_continuous, warm_up
from teamformer.trials.continuous_trial import ending_of
from teamformer.world.continuous.course import Course

OTHERS = Path(os.environ.get("TEAMFORMER_OTHERS", "/nowhere"))


@dataclass
class Timed:
    """The shared plan, and the processor seconds that each plan after the first one took."""

    seconds: list[float]

    def update(self, known: Known, plan: Plan | None) -> Plan:
        """Return its plan."""
        begun = time.process_time()
        made = SharedPlan().update(known, plan)
        if plan is not None:
            self.seconds.append(time.process_time() - begun)
        return made


def worth_of(mission: Mission) -> float:
    """Return the makespan of the plan of a mission, or its cost if it has one."""
    posed = pose_mission(mission)
    made = plan_continuous(posed, "plan", 0)
    assert made is not None
    return posed.worth_of(made)


def run(mission: Mission, seconds: list[float]) -> float:
    """Run a mission by the shared plan, and return the same of the run."""
    course = Course(mission, mission, Timed(seconds))
    course.begin()
    while course.is_running:
        course.go_on()
    ending = ending_of(course)
    assert ending.makespan is not None, ending
    return ending.makespan if ending.cost is None else ending.cost


def with_loss(mission: Mission, rng: np.random.Generator) -> tuple[Mission, Mission]:
    """Return a mission in which a robot is lost at a third of the plan, and hindsight's."""
    when = worth_of(replace(mission, cost=None)) / 3
    lost = int(rng.integers(len(mission.robots)))
    robots = list(mission.robots)
    robots[lost] = replace(robots[lost], absences=(Absence(when),))
    left = [robot for robot in range(len(robots)) if robot != lost]
    return replace(mission, robots=tuple(robots)), with_robots(mission, left)


def with_arrivals(mission: Mission, rng: np.random.Generator) -> tuple[Mission, Mission]:
    """Return a mission of which a fifth of the tasks appear one by one, for both.

    With windows each appears at 0.6 of the time at which its own begins.
    """
    end = worth_of(replace(mission, cost=None))
    late = rng.permutation(len(mission.tasks))[: len(mission.tasks) // 5]
    when = np.sort(rng.uniform(0.1, 0.6, len(late))) * end
    tasks = list(mission.tasks)
    for task, at in zip(late.tolist(), when.tolist(), strict=True):
        between = tasks[task].between
        tasks[task] = replace(tasks[task], appears=0.6 * between[0] if between else at)
    changed = replace(mission, tasks=tuple(tasks))
    return changed, changed


def roads(seed: int) -> Mission:
    """Return a mission of 40 tasks and 10 robots on roads between 30 places, not symmetric."""
    rng = np.random.default_rng(seed)
    spots = rng.uniform(0, 10, (30, 2))
    apart = np.hypot(*(spots[:, None] - spots[None]).transpose(2, 0, 1))
    times = np.round(apart * rng.uniform(1, 1.3, apart.shape), 3)
    near = np.argsort(np.argsort(apart, axis=1), axis=1) <= 4
    times[~(near | near.T)] = np.inf
    np.fill_diagonal(times, 0.0)
    caps = ("a", "b", "c")
    robots = [
        Robot(f"r{n}", (int(rng.integers(30)), 0), {caps[n % 3]: 1}, speed=(1.0, 0.5)[n % 2])
        for n in range(10)
    ]
    tasks = [
        Task(
            f"t{n}",
            (int(rng.integers(30)), 0),
            {cap: 1 for cap in caps if rng.random() < 0.5} or {"a": 1},
            duration=float(np.round(rng.uniform(0.5, 3), 2)),
        )
        for n in range(40)
    ]
    world = Roads(tuple(f"p{n}" for n in range(30)), {"ground": tuple(map(tuple, times.tolist()))})
    return Mission(
        "roads", world, caps, tuple(robots), tuple(tasks), time="continuous", ends="home"
    )


def imported(form: str, name: str) -> Mission:
    """Return an instance of others."""
    [mission] = import_missions(form, OTHERS / name)
    return mission


def home_care(patients: int, number: int) -> str:
    """Return the file of an instance of home care."""
    if patients == 50:  # of which there are three
        return f"hhcrsp/large/InstanzCPLEX_HCSRP_50_{2 * (number % 3) + 2}.json"
    return f"hhcrsp/instances/InstanzCPLEX_HCSRP_{patients}_{number + 1}.json"


SETS: dict[str, Callable[[int], Mission]] = {
    "RA-L, 20 tasks": lambda n: imported("hetero-mrta", f"ral/env_{n}.json"),
    "roads, 40 tasks": roads,
    "MA-AT-50-5-50": lambda n: imported(
        "hetero-mrta", f"heteromrta/MA-AT-50-5-50/env_{n % 5}.json"
    ),
    "HHCRSP, 25 patients": lambda n: imported("hhcrsp", home_care(25, n % 10)),
    "HHCRSP, 50 patients": lambda n: imported("hhcrsp", home_care(50, n % 10)),
    "MA-AT-50-5-200": lambda n: imported(
        "hetero-mrta", f"heteromrta/MA-AT-50-5-200/env_{n % 5}.json"
    ),
}


def main(runs: int, names: list[str]) -> None:
    """Print a row for each set of missions and each kind of incident."""
    warm_up()
    for name in names or list(SETS):
        for what, change in (("lost", with_loss), ("appear", with_arrivals)):
            ratios, seconds = [], list[float]()
            for number in range(runs):
                changed, hindsight = change(SETS[name](number), np.random.default_rng(number))
                ratios.append(run(changed, seconds) / worth_of(hindsight))
            mean, replans = statistics.mean(ratios), len(seconds) / runs
            print(
                f"| {name}, {what} | {mean:.3f} | {min(ratios):.2f} to {max(ratios):.2f} "
                f"| {replans:.1f} | {statistics.mean(seconds):.3f} | {max(seconds):.3f} |",
                flush=True,
            )


if __name__ == "__main__":
    main(int(sys.argv[1]), sys.argv[2:])
