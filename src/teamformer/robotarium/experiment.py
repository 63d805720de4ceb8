"""One experiment: a mission, a method and robots, simulated by the plant or Robotarium's own."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from teamformer.base.array_types import Array
from teamformer.methods.by_name import Player, as_method
from teamformer.mission.model import Mission
from teamformer.robotarium.control.qp_solvers import with_daqp
from teamformer.robotarium.flight import FlightOutcome, Watch, fly
from teamformer.robotarium.mission_checks import check_mission
from teamformer.robotarium.robots.arena import MIDDLE, TICK
from teamformer.robotarium.robots.plant import Plant, Violations, Weather
from teamformer.robotarium.robots.rps_robots import RpsRobots, is_accepted

Simulator = Literal["plant", "rps"]


@dataclass(frozen=True)
class Experiment:
    """What came of one; `report` is what Robotarium's own simulator said, if it was asked."""

    mission: Mission
    method: str
    seed: int
    outcome: FlightOutcome
    faults: Violations
    seconds: float  # of the clock, for the whole experiment
    report: str = ""

    @property
    def is_good(self) -> bool:
        """Say whether all tasks were done and no rule was broken."""
        is_clean = self.faults.is_clean and is_accepted(self.report)
        return self.outcome.is_completed and is_clean

    def row(self) -> dict[str, Any]:
        """Return what `--json` prints."""
        outcome, tally, faults = self.outcome, self.outcome.tally, self.faults
        last = max((tick for tick in outcome.done_at if tick is not None), default=None)
        makespan = last if outcome.is_completed and last is not None else None
        return {
            "mission": self.mission.name,
            "method": self.method,
            "seed": self.seed,
            "completed": outcome.is_completed,
            "status": tally.status,
            "makespan": tally.steps if outcome.is_completed else None,
            "makespan_seconds": None if makespan is None else round(makespan * TICK, 3),
            "steps": tally.steps,
            "ticks": outcome.ticks,
            "done_at_tick": list(outcome.done_at),
            "tasks_done": tally.tasks_done,
            "tasks": len(self.mission.tasks),
            "robots": len(self.mission.robots),
            "capabilities": len(self.mission.capabilities),
            "joins": tally.joins,
            "splits": tally.splits,
            "illegal_decisions": tally.illegal_decisions,
            "collisions": faults.collisions,
            "boundary_violations": faults.boundary_violations,
            "actuator_violations": faults.actuator_violations,
            "min_separation": round(faults.min_separation, 4),
            "decision_ms": round(1e3 * outcome.timing.decision, 3),
            "longest_decision_ms": round(1e3 * outcome.timing.longest_decision, 3),
            "tick_ms": round(1e3 * outcome.timing.tick, 3),
            "total_seconds": round(self.seconds, 3),
            **({"accepted": is_accepted(self.report)} if self.report else {}),
        }


def run_experiment(
    mission: Mission,
    player: Player,
    seed: int = 0,
    simulator: Simulator = "plant",
    weather: Weather | None = None,
    watch: Watch | None = None,
) -> Experiment:
    """Run one experiment; raises `MissionError` for a mission that robots have no room for."""
    check_mission(mission)
    method = as_method(player)
    begun = time.perf_counter()
    poses = start_poses(mission, seed)
    robots = Plant(poses, weather, seed) if simulator == "plant" else RpsRobots(poses)
    outcome = fly(
        mission=mission,
        policy=method.policy,
        robots=robots,
        solve=with_daqp(),
        seed=seed,
        watch=watch,
        coordinator=method.coordinator,
    )
    report = robots.finish() if isinstance(robots, RpsRobots) else ""
    return Experiment(
        mission=mission,
        method=method.name,
        seed=seed,
        outcome=outcome,
        faults=robots.faults,
        seconds=time.perf_counter() - begun,
        report=report,
    )


def start_poses(mission: Mission, seed: int) -> Array:
    """Return where the robots start, as (robots, 3): headings are random."""
    starts = np.array([robot.at for robot in mission.robots]) - MIDDLE
    headings = np.random.default_rng(seed).uniform(-np.pi, np.pi, len(starts))
    return np.column_stack((starts, headings))
