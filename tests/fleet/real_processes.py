"""Real processes under faults: `python tests/fleet/real_processes.py [RUNS] [FIRST]`.

Each run is `teamformer fleet` on another random mission of 20 robots and 20 tasks, with 30% of the
messages thrown away. Two agents are killed, one is killed and started again 5 s later, one is
stopped for 10 s; those that are left can do all tasks. Prints how each run ended; the exit status
is 1 if one did not.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from teamformer.fleet.mission import Mission
from teamformer.grid import Grid
from teamformer.model import Absence, Scenario
from teamformer.scenarios.files import write_scenario
from teamformer.scenarios.generate import Spec, generate

ROBOTS = TASKS = 20
WORLD = Grid(40, 40)
DROP = "0.3"
KILLED = (30, 36)
LOST, BACK = 33, 38
STOPPED, GOES_ON = 34, 44
"""Seconds of the mission; twenty processes take a while to start on two cores."""

LIMIT = 300


def draw(seed: int) -> tuple[Scenario, list[int]]:
    """Return a mission with a robot that is away for a while, and four robots to be disturbed.

    The first two are to be killed; without them all tasks can be done. Then comes the one that is
    away, and the one to be stopped.
    """
    rng = np.random.default_rng(seed)
    while True:
        scenario = generate(Spec(ROBOTS, TASKS, 4, requirements=2, world=WORLD), rng)
        who = rng.permutation(ROBOTS)[:4].tolist()
        mission, left = Mission(scenario), set(range(ROBOTS)) - set(who[:2])
        if all(mission.can_do(left, task) for task in mission.tasks):
            break
    robots = list(scenario.robots)
    robots[who[2]] = replace(robots[who[2]], absences=(Absence(LOST, BACK),))
    return replace(scenario, robots=tuple(robots)), who


class Agents:
    """The agents' processes by name, as `fleet` tells of them on stderr."""

    def __init__(self, lines: Iterable[str]) -> None:
        self._pids: dict[str, int] = {}
        self._lines = lines
        self.told: list[str] = []
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self) -> None:
        for line in self._lines:
            self.told.append(line.rstrip())
            match line.split():
                case ["agent", name, "pid", number]:
                    self._pids[name] = int(number)

    def send(self, name: str, number: signal.Signals) -> None:
        """Send a signal to an agent."""
        os.kill(self._pids[name], number)

    def wait_for(self, text: str) -> float:
        """Wait until something was told; return when."""
        while not any(text in line for line in self.told):
            time.sleep(0.05)
        return time.monotonic()


def run(seed: int) -> bool:
    """Run one mission; say how it ended, and return whether all was done."""
    scenario, who = draw(seed)
    names = [scenario.robots[robot].name for robot in who]
    happens = [
        (KILLED[0], names[0], signal.SIGKILL),
        (STOPPED, names[3], signal.SIGSTOP),
        (KILLED[1], names[1], signal.SIGKILL),
        (GOES_ON, names[3], signal.SIGCONT),
    ]
    with TemporaryDirectory() as folder:
        path = Path(folder) / "mission.yaml"
        write_scenario(scenario, path)
        command = [sys.executable, "-m", "teamformer.cli", "fleet", str(path), "--json"]
        command += ["--drop", DROP, "--time-limit", str(LIMIT)]
        pipe = subprocess.PIPE
        with subprocess.Popen(command, stdout=pipe, stderr=pipe, text=True) as fleet:
            assert fleet.stdout is not None
            assert fleet.stderr is not None
            agents = Agents(fleet.stderr)
            begun = agents.wait_for("world at")
            for at, name, number in happens:
                time.sleep(max(0.0, begun + at - time.monotonic()))
                if fleet.poll() is None:
                    agents.send(name, number)
            row = json.loads(fleet.stdout.read())
    print(
        f"seed {seed}: {row['tasks_done']} of {row['tasks']} tasks, makespan {row['makespan']} s, "
        f"{row['robots_alive']} of {ROBOTS} agents left",
        flush=True,
    )
    is_good = bool(row["completed"]) and row["makespan"] > GOES_ON
    if not is_good:
        print(*(f"  {line}" for line in agents.told), sep="\n", flush=True)
    return is_good


def main(runs: int, first: int) -> int:
    """Make some runs, and count those that ended after the last fault."""
    good = sum(run(seed) for seed in range(first, first + runs))
    print(f"{good} of {runs} ended")
    return 0 if good == runs else 1


if __name__ == "__main__":
    numbers = [int(argument) for argument in sys.argv[1:]]
    sys.exit(main(numbers[0] if numbers else 10, numbers[1] if numbers[1:] else 1))
