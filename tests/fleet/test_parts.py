"""Bodies that see only their own parts: a task is done when the parts of enough robots are over."""

from __future__ import annotations

import shutil
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager

import pytest

from fleets import agents_of, opened
from small_worlds import make, robot, task
from teamformer.fleet.agent.agent import Agent
from teamformer.fleet.bodies.body import Command, Report
from teamformer.fleet.bodies.vda5050 import tries
from teamformer.fleet.bodies.vda5050.body import Vda5050Body
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.messages import Message
from teamformer.fleet.process.fleet import free_ports
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.plane import Plane
from vda5050_vehicle import Vehicle, running, wait_for_port

NEVER = 10_000
CAPS = ("lift", "scan")


class PartBodies:
    """Bodies that are at once where they are sent; each needs so many ticks for its part."""

    def __init__(self, mission: FleetMission, ticks: list[int], unfit_from: dict[int, int]) -> None:
        self.places = [robot.at for robot in mission.source.robots]
        self.began: list[int] = [NEVER] * len(ticks)
        self.begun = [0] * len(ticks)  # how often each began
        self.last = [NEVER] * len(ticks)  # when each began last
        self._ticks, self._unfit_from = ticks, unfit_from

    def report(self, robot: int, tick: int, leg: int) -> Report:
        has_served = tick >= self.began[robot] + self._ticks[robot]
        is_unfit = tick >= self._unfit_from.get(robot, NEVER)
        report = Report(*self.places[robot], leg, number=tick)
        return report._replace(has_served=has_served, is_unfit=is_unfit)

    def command(self, robot: int, tick: int, command: Command) -> None:
        self.places[robot] = command.place or self.places[robot]
        if command.serve and self.began[robot] == NEVER:
            self.began[robot] = self.last[robot] = tick
            self.begun[robot] += 1
        elif not command.serve:
            self.began[robot] = NEVER


def play(agents: list[Agent], bodies: PartBodies, ticks: int) -> int | None:
    """Play agents that hear each other; return the tick in which the only task was done."""
    inbox: list[list[Message]] = [[] for _ in agents]
    for tick in range(1, ticks):
        heard, inbox = inbox, [[] for _ in agents]
        for me, agent in enumerate(agents):
            report = bodies.report(me, tick, agent.command.leg)
            command, notices = agent.tick(tick / 10, report, heard[me])
            bodies.command(me, tick, command)
            for other in {*range(len(agents))} - {me}:
                inbox[other] += opened(agent.mission, me, notices)
        if any(agent.knowledge.done for agent in agents):
            return tick
    return None


def test_a_task_is_done_when_the_last_part_is_over() -> None:
    mission = FleetMission(make([robot("a", 2), robot("b", 9)], [task("ab", 5)]))
    bodies = PartBodies(mission, [20, 60], {})
    agents = agents_of(mission)
    done = play(agents, bodies, 200)
    assert done is not None
    assert bodies.last[1] + 60 <= done <= bodies.last[1] + 62
    assert bodies.begun == [1, 1]
    [deed] = [deed for agent in agents for deed in agent.knowledge.deeds.values()]
    assert deed.robots == (0, 1)


def test_who_has_served_serves_again_if_the_other_one_fails() -> None:
    """Robot 1 fails in its part when robot 0 has done its own: nothing is done until 2 has come."""
    mission = FleetMission(make([robot("a", 2), robot("b", 9), robot("b", 15)], [task("ab", 5)]))
    alone = PartBodies(mission, [20, NEVER, NEVER], {1: 60, 2: 0})
    assert play(agents_of(mission), alone, 400) is None
    assert alone.begun == [1, 1, 0]
    bodies = PartBodies(mission, [20, NEVER, 30], {1: 60})
    done = play(agents_of(mission), bodies, 400)
    assert done is not None
    assert bodies.begun == [2, 1, 1]
    assert bodies.last[2] > 60
    assert bodies.last[2] + 30 <= done <= bodies.last[2] + 32


@pytest.mark.skipif(shutil.which("mosquitto") is None, reason="needs mosquitto")
def test_a_task_of_two_vehicles_waits_for_the_one_that_fails(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The second vehicle fails to serve twice; that the first has served is not enough."""
    monkeypatch.setattr(tries, "AGAIN", 0.05)
    robots = [Robot(f"v{n + 1}", (1.0, 1.0), {cap: 1}, 2.0) for n, cap in enumerate(CAPS)]
    both = Task("both", (1.0, 1.0), dict.fromkeys(CAPS, 1), 2)
    mission = FleetMission(Mission("yard", Plane(20.0, 20.0), CAPS, tuple(robots), (both,)))
    seen: list[tuple[bool, int]] = []  # whether it counts as done, how often v2 was told to serve
    with two_driven(mission) as (bodies, vehicles):
        vehicles[1].fails["serve"] = 2
        agents = agents_of(mission, now=time.monotonic())
        inbox: list[list[Message]] = [[], []]
        for _ in range(400):
            heard, inbox = inbox, [[], []]
            for me, (agent, body, vehicle) in enumerate(zip(agents, bodies, vehicles, strict=True)):
                vehicle.say()
                report = body.report()
                if report is not None:
                    command, notices = agent.tick(time.monotonic(), report, heard[me])
                    body.command(command)
                    inbox[1 - me] += opened(mission, me, notices)
            told = len({action["actionId"] for action in vehicles[1].actions})
            seen.append((any(agent.is_over for agent in agents), told))
            if all(agent.is_over for agent in agents):
                break
            time.sleep(0.02)
    assert {told for is_done, told in seen if is_done} == {3}
    assert all(agent.is_over for agent in agents)
    assert len({action["actionId"] for action in vehicles[0].actions}) == 1


@contextmanager
def two_driven(mission: FleetMission) -> Iterator[tuple[list[Vda5050Body], list[Vehicle]]]:
    """Yield the bodies of two vehicles, and these, over one broker."""
    [port] = free_ports(1)
    with ExitStack() as stack:
        stack.enter_context(running("mosquitto", "-p", str(port)))
        wait_for_port(port)
        vehicles = [Vehicle(port, "2.0.0", serial=serial) for serial in ("v1", "v2")]
        url = f"mqtt://127.0.0.1:{port}/uagv/acme"
        bodies = [Vda5050Body(f"{url}/v{n + 1}?map=yard", mission, n) for n in (0, 1)]
        for end in (*(v.leave for v in vehicles), *(b.close for b in bodies)):
            stack.callback(end)
        yield bodies, vehicles
