"""The bodies that come with Teamformer, as `--body` names them."""

from __future__ import annotations

from importlib.util import find_spec
from typing import TYPE_CHECKING

from teamformer.base.errors import TeamformerError
from teamformer.base.extras import require
from teamformer.fleet.bodies.body import Body

if TYPE_CHECKING:
    from teamformer.fleet.bodies.remote import Line
    from teamformer.fleet.fleet_mission import FleetMission


def simulated(mission: FleetMission, robot: int, address: str, line: Line) -> Body:
    """Return the body of a robot in the world that another process simulates."""
    from teamformer.fleet.bodies.remote import RemoteBody

    return RemoteBody(line, robot)


def vda5050(mission: FleetMission, robot: int, address: str, line: Line) -> Body:
    """Return the body of a vehicle behind an MQTT broker."""
    require("fleet", "paho")
    from teamformer.fleet.bodies.vda5050.body import Vda5050Body

    return Vda5050Body(address, mission, robot)


def nav2(mission: FleetMission, robot: int, address: str, line: Line) -> Body:
    """Return the body of a robot in a ROS graph, once ROS is found to be there."""
    from teamformer.fleet.bodies.ros2.address import read_address

    where = read_address(address, mission.source.robots[robot].name)
    if find_spec("rclpy") is None:
        raise TeamformerError(
            "--body nav2 needs ROS 2: this Python has no rclpy",
            "source ROS 2's setup.bash, and install teamformer for ROS's Python;"
            " see docs/how-to/ros2.md",
        )
    from teamformer.fleet.bodies.ros2.body import Nav2Body

    return Nav2Body(where, mission, robot)
