"""A whole fleet on this machine: a process for each robot, and one for the simulated bodies."""

from __future__ import annotations

import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterable
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from teamformer.fleet.agent.planning import first_plan
from teamformer.fleet.bodies.simulated import Done
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.methods import PLAN, planner_of
from teamformer.fleet.process.local_agent import MODULE, Start, write_start
from teamformer.fleet.process.world_server import WorldServer
from teamformer.fleet.transports.keys import read_keys
from teamformer.fleet.transports.zenoh_mesh import ZenohTransport
from teamformer.world.rules.constants import NOBODY

LAST_WORDS = 2.0
"""Seconds that a fleet goes on after its last task: two heartbeats."""

PATIENCE = 10.0
"""Seconds that agents have to leave in order before they are ended."""


@dataclass(frozen=True)
class FleetResult:
    """What came of it; times in seconds."""

    completed: bool
    done: tuple[Done, ...]
    tasks: int
    robots_alive: int
    names: dict[int, str]


class LocalFleet:
    """Starts the processes, and holds the world until the mission ends.

    `keys` is the folder of the fleet's keys, if its messages are to be protected. `drop` is the
    part of incoming messages that each agent throws away, for trials. Raises `TeamformerError` for
    keys that cannot be used.
    """

    def __init__(
        self,
        mission: FleetMission,
        tell: Callable[[str], None],
        method: str = PLAN,
        keys: Path | None = None,
        drop: float = 0.0,
    ) -> None:
        self._mission, self._tell = mission, tell
        self._method, self._drop = method, drop
        self._folder = keys
        self._keys = read_keys(keys)
        self._signatures = self._keys.signatures(mission, None)
        self._agents: list[subprocess.Popen[bytes]] = []
        self._place = Path()  # the folder that tells agents all they have to know

    def run(self, seconds: float) -> FleetResult:
        """Run until all is done or so many seconds have passed."""
        robots = self._mission.source.robots
        self._tell("making the first plan ...")
        plan = first_plan(self._mission, planner_of(self._method))
        with TemporaryDirectory(prefix="teamformer-fleet-") as temporary:
            endpoints = tuple(f"tcp/127.0.0.1:{port}" for port in free_ports(len(robots) + 1))
            keys = None if self._folder is None else str(self._folder)
            self._place = Path(temporary)
            start = Start(plan.note, endpoints, self._method, self._drop, keys)
            write_start(self._place, self._mission.source, start)
            transport = ZenohTransport(self._mission.number, NOBODY, endpoints[-1], ())
            try:
                secret = self._keys.secret
                server = WorldServer(self._mission, transport, secret, self._signatures)
                self._tell(f"world at {endpoints[-1]}")
                for number in range(len(robots)):
                    self._agents.append(self._start(number))
                return self._hold(server, seconds)
            finally:
                self._end()
                transport.close()

    def _start(self, robot: int) -> subprocess.Popen[bytes]:
        """Start an agent, or start it anew, and say which process it is."""
        command, nowhere = [sys.executable, "-m", MODULE], subprocess.DEVNULL
        command += [str(self._place), str(robot)]
        agent = subprocess.Popen(command, stdin=nowhere, stdout=nowhere)
        self._tell(f"agent {self._mission.source.robots[robot].name} pid {agent.pid}")
        return agent

    def _hold(self, server: WorldServer, seconds: float) -> FleetResult:
        mission, world = self._mission, server.world
        absences = [(a, n) for n, at in enumerate(server.truth.robots) for a in at.absences]
        losses = _moments(mission, ((away.lost, robot) for away, robot in absences))
        returns = _moments(mission, ((away.back, robot) for away, robot in absences))
        told: set[int] = set()
        self._wait_for_all(server, told)
        while server.now < seconds and not world.is_over:
            for done in server.step():
                who = ", ".join(mission.source.robots[robot].name for robot in done.robots)
                self._tell(f"{done.at:.2f} s: {world.tasks[done.key].name} done by {who}")
            while losses and losses[-1][0] <= server.now:
                self._agents[losses.pop()[1]].kill()
            while returns and returns[-1][0] <= server.now:
                robot = returns.pop()[1]
                self._agents[robot].wait()
                self._agents[robot] = self._start(robot)
                told.discard(robot)
            self._tell_who_has_ended(server, told)
        self._let_all_hear(server)
        alive = sum(agent.poll() is None for agent in self._agents)
        names = {key: task.name for key, task in world.tasks.items()}
        is_completed = world.is_over and all(map(mission.may_miss, world.missed))
        return FleetResult(is_completed, tuple(world.done.values()), len(world.tasks), alive, names)

    def _let_all_hear(self, server: WorldServer) -> None:
        """Go on for a moment, so that robots and onlookers hear of the last task too."""
        until = time.monotonic() + LAST_WORDS
        while time.monotonic() < until:
            server.step()

    def _wait_for_all(self, server: WorldServer, told: set[int]) -> None:
        """Wait until time begins, and say who is ready meanwhile."""
        begun, ready = time.monotonic(), list[int]()
        robots = self._mission.source.robots
        while not server.has_begun:
            for robot in sorted(server.ready.difference(ready)):
                ready.append(robot)
                after = f"{time.monotonic() - begun:.1f} s, {len(ready)} of {len(robots)}"
                self._tell(f"agent {robots[robot].name} ready after {after}")
            server.step()
            self._tell_who_has_ended(server, told)
        self._tell(f"time begins, {time.monotonic() - begun:.1f} s after the agents were started")

    def _tell_who_has_ended(self, server: WorldServer, told: set[int]) -> None:
        for robot, agent in enumerate(self._agents):
            if agent.poll() is not None and robot not in told:
                told.add(robot)
                name = self._mission.source.robots[robot].name
                self._tell(f"{server.now:.2f} s: agent {name} has ended ({agent.returncode})")

    def _end(self) -> None:
        """Let all agents leave in order; end those that do not."""
        for agent in self._agents:
            if agent.poll() is None:
                agent.send_signal(signal.SIGCONT)
                agent.terminate()
        deadline = time.monotonic() + PATIENCE
        for agent in self._agents:
            try:
                agent.wait(max(0.1, deadline - time.monotonic()))
            except subprocess.TimeoutExpired:
                agent.kill()
                agent.wait()


def _moments(
    mission: FleetMission, moments: Iterable[tuple[float | None, int]]
) -> list[tuple[float, int]]:
    """Return the seconds at which moments come, with the robots that they are of, last first."""
    known = ((moment, robot) for moment, robot in moments if moment is not None)
    return sorted(((mission.begin_of(moment), robot) for moment, robot in known), reverse=True)


def free_ports(number: int) -> list[int]:
    """Return ports of this machine that nobody listens to."""
    sockets = [socket.socket() for _ in range(number)]
    try:
        for each in sockets:
            each.bind(("127.0.0.1", 0))
        return [each.getsockname()[1] for each in sockets]
    finally:
        for each in sockets:
            with closing(each):
                pass
