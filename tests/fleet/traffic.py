"""What fleets of different sizes say, hear and think: `python tests/fleet/traffic.py [ROBOTS...]`.

Rehearses a minute of random missions, one task for each robot, at two loads of the network, and
times each tick of each agent. Coalitions are the nearest robots that can, so that a thousand
robots have a plan at once; what a plan says plays no part in what is measured.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence

import numpy as np

from teamformer.fleet.agent.agent import Agent
from teamformer.fleet.agent.planning import first_plan
from teamformer.fleet.bodies.body import Command, Report
from teamformer.fleet.messages import Message, Notice
from teamformer.fleet.mission import Mission
from teamformer.fleet.planner import Situation, Stop
from teamformer.fleet.rehearsal.faults import Faults
from teamformer.fleet.rehearsal.play import Rehearsal
from teamformer.grid import Grid
from teamformer.scenarios.generate import Spec, generate

SECONDS = 60.0
CELLS_A_ROBOT = 10


class NearestPlanner:
    """Gives each task, in order, the robots nearest to it that bring something it lacks."""

    def plan(self, mission: Mission, situation: Situation) -> Sequence[Stop]:
        places = dict(situation.places)
        stops = []
        for task in situation.tasks:
            lacking = np.array(task.needs)
            coalition = []
            for robot in sorted(places, key=lambda r: _away(places[r], (task.x, task.y))):
                brings = np.array(mission.counts[robot])
                if np.minimum(brings, lacking).max() > 0:
                    coalition.append(robot)
                    lacking = lacking - brings
                if lacking.max() <= 0:
                    break
            places.update((robot, (task.x, task.y)) for robot in coalition)
            stops.append((task.key, tuple(sorted(coalition))))
        return stops


def _away(place: tuple[float, float], other: tuple[float, float]) -> float:
    return abs(place[0] - other[0]) + abs(place[1] - other[1])


def main(sizes: Sequence[int]) -> None:
    ticks: list[int] = []
    tick = Agent.tick

    def timed(
        self: Agent, now: float, report: Report, inbox: Sequence[Message]
    ) -> tuple[Command, list[Notice]]:
        begun = time.thread_time_ns()
        result = tick(self, now, report, inbox)
        ticks.append(time.thread_time_ns() - begun)
        return result

    Agent.tick = timed  # type: ignore[method-assign]
    for robots in sizes:
        side = int(np.sqrt(CELLS_A_ROBOT * robots))
        spec = Spec(robots, robots, capabilities=6, requirements=2, world=Grid(side, side))
        mission = Mission(generate(spec, np.random.default_rng(1)))
        plan = first_plan(mission, NearestPlanner())
        for loss in (0.0, 0.3):
            ticks.clear()
            faults = Faults(seed=1, loss=loss)
            outcome = Rehearsal(mission, NearestPlanner(), plan, faults).run(SECONDS)
            seconds, took = outcome.robot_seconds, np.array(ticks) / 1e6
            print(
                f"{robots} robots, {loss:.0%} lost, {outcome.end:.0f} s, "
                f"{outcome.tasks_done} tasks done: each says {outcome.messages / seconds:.2f} "
                f"messages, {outcome.bytes / seconds:.0f} bytes a second and hears "
                f"{outcome.received_bytes / seconds:.0f}; a tick takes "
                f"{took.mean():.3f} ms, one in a hundred {np.percentile(took, 99):.3f}"
            )
            sys.stdout.flush()


if __name__ == "__main__":
    main([int(argument) for argument in sys.argv[1:]] or [10, 100, 1000])
