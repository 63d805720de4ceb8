"""Rehearses many random missions: `python tests/fleet/many_worlds.py FIRST LAST [SCHEDULES]`.

Missions are numbered: of four to eight robots and up to twenty tasks on grids and planes, some with
late tasks, and now and then one of the kinds that people have. Prints a line for each, with the
schedules that blocked or broke a promise; `judge` with the mission's number as seed plays them
again.
"""

from __future__ import annotations

import sys
import time
from collections import Counter
from pathlib import Path

import numpy as np

from teamformer.fleet.mission import Mission, seconds_a_step
from teamformer.fleet.rehearsal.faults import Knobs
from teamformer.fleet.rehearsal.rehearse import judge, set_stage
from teamformer.model import Scenario
from teamformer.plane import Plane
from teamformer.scenarios.files import read_scenario
from teamformer.scenarios.generate import Spec, generate
from teamformer.scenarios.named_settings import world_of

WAREHOUSE = Path(__file__).parents[2] / "examples" / "warehouse.yaml"
FAMILIES = ("sparse", "real", "warehouse")
KINDS = 12
LARGE = 6
"""Missions that people have get so many times fewer schedules: they take so much longer."""


def world(number: int) -> tuple[Scenario, bool]:
    """Return a mission by its number, and whether it is a large one."""
    rng = np.random.default_rng(90_000 + number)
    kind = number % KINDS
    robots, tasks, caps = (int(rng.integers(*ends)) for ends in ((4, 9), (4, 21), (1, 5)))
    if kind == 11:
        return read_scenario(WAREHOUSE), False
    if kind == 10:
        return world_of(FAMILIES[number // KINDS % len(FAMILIES)], number), True
    if kind == 9:
        return generate(Spec(robots, tasks, caps, late_tasks=3), rng), False
    if kind == 8:
        plane = Plane(20.0, 20.0, step=0.5, arrival_radius=0.5)
        return generate(Spec(robots, tasks, caps, world=plane), rng), False
    return generate(Spec(robots, tasks, caps), rng), False


def main(first: int, last: int, schedules: int) -> None:
    """Rehearse the missions from `first` to before `last`."""
    total: Counter[str] = Counter()
    for number in range(first, last):
        scenario, is_large = world(number)
        stage = set_stage(Mission(scenario, seconds_a_step(scenario)))
        begun, played = time.process_time(), schedules // (LARGE if is_large else 1)
        verdicts = [judge(stage, number, Knobs(), schedule) for schedule in range(played)]
        seconds = (time.process_time() - begun) / played
        counts = Counter(verdict.outcome.status for verdict in verdicts)
        counts["broken"] = sum(bool(verdict.violations) for verdict in verdicts)
        total += counts
        print(
            f"{number}: {len(scenario.robots)} robots, {len(scenario.tasks)} tasks, {dict(counts)},"
            f" {seconds:.3f} s each",
            *(verdict for verdict in verdicts if not verdict.is_good),
            flush=True,
        )
    print("all:", dict(total))


if __name__ == "__main__":
    numbers = [int(argument) for argument in sys.argv[1:]]
    main(numbers[0], numbers[1], numbers[2] if numbers[2:] else 30)
