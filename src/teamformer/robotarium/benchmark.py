"""`bench robotarium`: many random missions, and whether any broke a rule."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np

from teamformer.methods.by_name import load_method
from teamformer.mission.model import Mission
from teamformer.robotarium.experiment import Experiment, Simulator, run_experiment
from teamformer.robotarium.random_missions import random_mission
from teamformer.robotarium.robots.plant import Weather

SIZES = {"20 robots, 5 tasks": (20, 5, 10), "4 robots, 3 tasks": (4, 3, 4)}
"""Robots, tasks and capabilities of each setting."""

ROUGH = Weather(delay=0.066, blur=0.002, turn_blur=float(np.deg2rad(1.0)))
"""Two ticks late, 2 mm and 1 degree."""

RPS_SHARE = 5  # every fifth mission is flown on Robotarium's own simulator too


def bench_robotarium(
    trials: int, method: str = "plan", first_seed: int = 0, with_rps: bool = False
) -> Iterator[dict[str, Any]]:
    """Yield a row for every mission, with `suite` and `setting` besides what `row()` has.

    Missions of a setting differ by seed. In rows of `rps` there is `same_as_plant`: whether the
    same tasks were done in the same ticks.
    """
    for size, (robots, tasks, capabilities) in SIZES.items():
        for seed in range(first_seed, first_seed + trials):
            mission = random_mission(robots, tasks, capabilities, np.random.default_rng(seed))
            fly = partial(_fly, mission, method, seed)
            calm = fly("plant")
            yield _row(size, "plant", calm)
            yield _row(size, "plant, late and blurred", fly("plant", ROUGH))
            if with_rps and (seed - first_seed) % RPS_SHARE == 0:
                official = fly("rps")
                is_same = official.outcome.done_at == calm.outcome.done_at
                yield {**_row(size, "rps", official), "same_as_plant": is_same}


def _fly(
    mission: Mission,
    method: str,
    seed: int,
    simulator: Simulator,
    weather: Weather | None = None,
) -> Experiment:
    """Fly a mission by a method that begins anew, since it may remember an earlier one."""
    return run_experiment(mission, load_method(method), seed, simulator, weather)


def count_missions(trials: int, with_rps: bool) -> int:
    """Return how many rows `bench_robotarium` yields."""
    official = -(-trials // RPS_SHARE) if with_rps else 0
    return len(SIZES) * (2 * trials + official)


def _row(size: str, where: str, done: Experiment) -> dict[str, Any]:
    return {"suite": "robotarium", "setting": f"{size}, {where}", **done.row()}


def summarise(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return for each setting how many missions were good, and means and extremes of the others."""
    summaries = []
    for setting in dict.fromkeys(row["setting"] for row in rows):
        own = [row for row in rows if row["setting"] == setting]
        times = [row["makespan_seconds"] for row in own if row["makespan_seconds"] is not None]
        summaries.append(
            {
                "setting": setting,
                "missions": len(own),
                "completed": sum(row["completed"] for row in own),
                "collisions": sum(row["collisions"] for row in own),
                "boundary": sum(row["boundary_violations"] for row in own),
                "actuator": sum(row["actuator_violations"] for row in own),
                "nearest, m": min(row["min_separation"] for row in own),
                "mean time, s": round(float(np.mean(times)), 1) if times else None,
                "longest, s": max(times, default=None),
                "decision, ms": max(row["longest_decision_ms"] for row in own),
                "tick, ms": max(row["tick_ms"] for row in own),
            }
        )
    return summaries
