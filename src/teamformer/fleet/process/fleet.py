"""A whole fleet on this machine: a process for each robot, and one for the simulated bodies."""

from __future__ import annotations

import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterable, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from msgspec.msgpack import encode

from teamformer.fleet.agent.planning import first_plan
from teamformer.fleet.bodies.world import Done
from teamformer.fleet.messages import NOBODY
from teamformer.fleet.methods import PLAN, planner_of
from teamformer.fleet.mission import Mission
from teamformer.fleet.process.world_server import WorldServer
from teamformer.fleet.transports.zenoh_mesh import ZenohTransport
from teamformer.scenarios.files import write_scenario

if TYPE_CHECKING:
    from teamformer.fleet.signatures import Signatures

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
    """Starts the processes, and holds the world until the mission ends."""

    def __init__(
        self,
        mission: Mission,
        pace: float,
        drop: float,
        folder: Path,
        tell: Callable[[str], None],
        more: Sequence[str] = (),
        signatures: Signatures | None = None,
        method: str = PLAN,
    ) -> None:
        self._method = method
        self._mission, self._pace, self._drop = mission, pace, drop
        self._folder, self._tell = folder, tell
        self._more = tuple(more)  # that agents are told besides
        self._signatures = signatures
        self._agents: list[subprocess.Popen[bytes]] = []
        self._commands: list[list[str]] = []  # that start them

    def run(self, seconds: float) -> FleetResult:
        """Run until all is done or so many seconds have passed."""
        robots = self._mission.scenario.robots
        plan = first_plan(self._mission, planner_of(self._method))
        with TemporaryDirectory(prefix="teamformer-fleet-") as temporary:
            scenario, ship = Path(temporary) / "mission.json", Path(temporary) / "plan"
            write_scenario(self._mission.scenario, scenario)
            ship.write_bytes(encode(plan.note))
            endpoints = [f"tcp/127.0.0.1:{port}" for port in free_ports(len(robots) + 1)]
            transport = ZenohTransport(self._mission.number, NOBODY, endpoints[-1], ())
            try:
                server = WorldServer(self._mission, transport, b"", self._signatures)
                self._tell(f"world at {endpoints[-1]}")
                for number in range(len(robots)):
                    self._commands.append(self._command(number, scenario, ship, endpoints))
                    self._agents.append(self._start(number))
                return self._hold(server, seconds)
            finally:
                self._end()
                transport.close()

    def _start(self, robot: int) -> subprocess.Popen[bytes]:
        """Start an agent, or start it anew, and say which process it is."""
        nowhere = subprocess.DEVNULL
        agent = subprocess.Popen(self._commands[robot], stdin=nowhere, stdout=nowhere)
        self._tell(f"agent {self._mission.scenario.robots[robot].name} pid {agent.pid}")
        return agent

    def _command(
        self, robot: int, scenario: Path, ship: Path, endpoints: Sequence[str]
    ) -> list[str]:
        """Return what starts an agent; it dials the world and all agents before it."""
        name = self._mission.scenario.robots[robot].name
        command = [sys.executable, "-m", "teamformer.cli", "agent", str(scenario)]
        command += ["--robot", name, "--body", "sim", "--listen", endpoints[robot]]
        command += ["--plan", str(ship), "--pace", repr(self._pace), "--drop", repr(self._drop)]
        command += ["--facts", str(self._folder / f"facts-{robot}")]
        command += ["--method", self._method, *self._more]
        for endpoint in (endpoints[-1], *endpoints[:robot]):
            command += ["--connect", endpoint]
        return command

    def _hold(self, server: WorldServer, seconds: float) -> FleetResult:
        mission, world = self._mission, server.world
        absences = [(a, n) for n, at in enumerate(mission.scenario.robots) for a in at.absences]
        losses = _moments(((away.lost, robot) for away, robot in absences), mission.step)
        returns = _moments(((away.back, robot) for away, robot in absences), mission.step)
        told: set[int] = set()
        while server.now < seconds and len(world.done) < len(world.tasks):
            for done in server.step():
                who = ", ".join(mission.scenario.robots[robot].name for robot in done.robots)
                self._tell(f"{done.at:.2f} s: {world.tasks[done.key].name} done by {who}")
            while losses and losses[-1][0] <= server.now:
                self._agents[losses.pop()[1]].kill()
            while returns and returns[-1][0] <= server.now:
                robot = returns.pop()[1]
                self._agents[robot].wait()
                self._agents[robot] = self._start(robot)
                told.discard(robot)
            for robot, agent in enumerate(self._agents):
                if agent.poll() is not None and robot not in told:
                    told.add(robot)
                    name = mission.scenario.robots[robot].name
                    self._tell(f"{server.now:.2f} s: agent {name} has ended ({agent.returncode})")
        alive = sum(agent.poll() is None for agent in self._agents)
        names = {key: task.name for key, task in world.tasks.items()}
        completed = len(world.done) == len(world.tasks)
        return FleetResult(completed, tuple(world.done.values()), len(world.tasks), alive, names)

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


def _moments(steps: Iterable[tuple[int | None, int]], length: float) -> list[tuple[float, int]]:
    """Return the seconds at which steps begin, with the robots that they are of, the last first."""
    known = ((step, robot) for step, robot in steps if step is not None)
    return sorted((((step - 1) * length, robot) for step, robot in known), reverse=True)


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
