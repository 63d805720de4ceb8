"""`teamformer fleet agent`: one robot's mind."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from teamformer.commands.console import say
from teamformer.commands.robots.mesh import check_method, read_fleet_mission
from teamformer.errors import TeamformerError
from teamformer.extras import require
from teamformer.model import Scenario

if TYPE_CHECKING:
    from teamformer.fleet.bodies.body import Body
    from teamformer.fleet.fleet_mission import Mission
    from teamformer.fleet.transports.zenoh_mesh import ZenohTransport


@dataclass(frozen=True)
class Options:
    """What the command line says."""

    robot: str
    body: str
    listen: str | None
    connect: tuple[str, ...]
    keys: Path | None
    facts: Path | None
    method: str = "plan"


def agent(path: Path, options: Options) -> int:
    """Run the mind of a robot until it is told to end; return the exit status."""
    mission = read_fleet_mission(path, "zenoh")
    from teamformer.fleet.agent.planning import first_plan
    from teamformer.fleet.methods import planner_of
    from teamformer.fleet.process.facts_file import FactsFile
    from teamformer.fleet.process.loop import AgentProcess
    from teamformer.fleet.transports.keys import read_keys
    from teamformer.fleet.transports.zenoh_mesh import ZenohTransport

    robot = _number_of(mission.scenario, options.robot)
    keys = read_keys(options.keys)
    endpoints = [*([options.listen] if options.listen else []), *options.connect]
    if not endpoints:
        raise TeamformerError(
            "the agent has no way to the others", "add --listen ENDPOINT or --connect ENDPOINT"
        )
    keys.check(endpoints)
    signatures = keys.signatures(mission, robot)
    facts = FactsFile(options.facts, mission.number, robot) if options.facts else None
    if facts is not None:
        facts.read()  # a broken file is told before anything moves
    check_method(options.method)
    say(f"{options.robot}: making the first plan ...")
    plan = first_plan(mission, planner_of(options.method))
    make_body = _body_maker(options.body, mission, robot)
    ends = (options.listen, options.connect)
    transport = ZenohTransport(mission.number, robot, *ends, certificates=keys.certificates)
    try:
        body = make_body(transport)
        told = (keys.secret, facts, signatures, options.method)
        process = AgentProcess(mission, robot, plan, transport, body, *told, tells=True)
        say(f"agent {options.robot} of mission {mission.number:x}")
        return process.run()
    finally:
        transport.close()


def _number_of(scenario: Scenario, name: str) -> int:
    names = [robot.name for robot in scenario.robots]
    if name not in names:
        shown = ", ".join(names[:12]) + (", ..." if len(names) > 12 else "")
        raise TeamformerError(f"there is no robot '{name}' in the mission", f"there are {shown}")
    return names.index(name)


def _body_maker(name: str, mission: Mission, robot: int) -> Callable[[ZenohTransport], Body]:
    """Return what makes the body once there is a transport; the simulated one needs it."""
    from teamformer.fleet.bodies.own import OwnBody
    from teamformer.fleet.bodies.remote import RemoteBody

    kind, _, rest = name.partition(":")
    if kind == "sim":
        return lambda transport: RemoteBody(transport, robot)
    if kind == "vda5050":
        require("fleet", "paho")
        from teamformer.fleet.bodies.vda5050.body import Vda5050Body

        return lambda _: Vda5050Body(rest, mission, robot)
    if kind == "nav2":
        make = _nav2_maker(rest, mission, robot)
        return lambda _: make()
    own = OwnBody(name, mission, robot)
    return lambda _: own


def _nav2_maker(text: str, mission: Mission, robot: int) -> Callable[[], Body]:
    """Return what makes the body of a robot in a ROS graph, once ROS is found to be there."""
    from teamformer.fleet.bodies.ros2.address import read_address

    address = read_address(text, mission.scenario.robots[robot].name)
    if find_spec("rclpy") is None:
        raise TeamformerError(
            "--body nav2 needs ROS 2: this Python has no rclpy",
            "source ROS 2's setup.bash, and install teamformer for ROS's Python;"
            " see docs/how-to/ros2.md",
        )
    from teamformer.fleet.bodies.ros2.body import Nav2Body

    return lambda: Nav2Body(address, mission, robot)
