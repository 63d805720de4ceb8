"""Twenty agents as processes of their own, under faults: those that are left do all tasks."""

from __future__ import annotations

import os
import signal
import threading
import time
from dataclasses import replace

import numpy as np
import pytest

from teamformer.files.drawn.generate import Spec, generate
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.process.fleet import LocalFleet
from teamformer.mission.model import Absence, Mission
from teamformer.mission.parts.grid import Grid

ROBOTS = TASKS = 20
WORLD = Grid(40, 40)
DROP = 0.3
KILLED = (30, 36)
LOST, BACK = 33, 38
STOPPED, GOES_ON = 34, 44
"""Seconds of the mission; twenty processes take a while to start on two cores."""

LIMIT = 300


def draw(seed: int) -> tuple[Mission, list[int]]:
    """Return a mission with a robot that is away for a while, and four robots to be disturbed.

    The first two are to be killed; without them all tasks can be done. Then comes the one that is
    away, and the one to be stopped.
    """
    rng = np.random.default_rng(seed)
    while True:
        source = generate(Spec(ROBOTS, TASKS, 4, requirements=2, world=WORLD), rng)
        who = rng.permutation(ROBOTS)[:4].tolist()
        mission, left = FleetMission(source), set(range(ROBOTS)) - set(who[:2])
        if all(mission.can_do(left, task) for task in mission.tasks):
            break
    robots = list(source.robots)
    robots[who[2]] = replace(robots[who[2]], absences=(Absence(LOST, BACK),))
    return replace(source, robots=tuple(robots)), who


class Disturber:
    """Learns the agents' processes from what the fleet tells, and sends them signals in time."""

    def __init__(self, happens: list[tuple[int, str, signal.Signals]]) -> None:
        self.told: list[str] = []
        self._pids: dict[str, int] = {}
        self._happens = happens

    def tell(self, line: str) -> None:
        self.told.append(line)
        match line.split():
            case ["world", "at", _]:
                threading.Thread(target=self._disturb, daemon=True).start()
            case ["agent", name, "pid", number]:
                self._pids[name] = int(number)

    def _disturb(self) -> None:
        begun = time.monotonic()
        for at, name, number in self._happens:
            time.sleep(max(0.0, begun + at - time.monotonic()))
            os.kill(self._pids[name], number)


@pytest.mark.slow
def test_a_fleet_survives_kills_a_stop_and_lost_messages() -> None:
    mission, who = draw(1)
    names = [mission.robots[robot].name for robot in who]
    disturber = Disturber(
        [
            (KILLED[0], names[0], signal.SIGKILL),
            (STOPPED, names[3], signal.SIGSTOP),
            (KILLED[1], names[1], signal.SIGKILL),
            (GOES_ON, names[3], signal.SIGCONT),
        ]
    )
    result = LocalFleet(FleetMission(mission), disturber.tell, drop=DROP).run(LIMIT)
    assert result.completed, disturber.told
    assert result.robots_alive == ROBOTS - 2
    assert max(done.at for done in result.done) > GOES_ON
