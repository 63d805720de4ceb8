"""What RViz shows of a robot's mission: its tasks, where it heads for, and whether it serves."""

from __future__ import annotations

from typing import Any

from builtin_interfaces.msg import Time
from geometry_msgs.msg import Point
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from visualization_msgs.msg import Marker, MarkerArray

from teamformer.fleet.bodies.body import Command
from teamformer.fleet.bodies.ros2.coordinates import metres_of
from teamformer.fleet.fleet_mission import FleetMission

TOPIC = "mission"

GREY, BLUE, GREEN = (0.6, 0.6, 0.6), (0.2, 0.4, 0.9), (0.1, 0.7, 0.3)

ROBOT, WAY = 1000000, 1000001
"""Numbers of the robot's own markers; a task's are below, one for the box and one for the name."""


class Markers:
    """Publishes markers on `mission`, latched, whenever they change."""

    def __init__(self, node: Node, mission: FleetMission, robot: int, frame: str) -> None:
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self._publisher = node.create_publisher(MarkerArray, TOPIC, latched)
        self._mission, self._frame = mission, frame
        self._name = mission.source.robots[robot].name
        self._shown: tuple[Any, ...] = ()

    def show(self, at: tuple[float, float], command: Command) -> None:
        """Show the robot in metres of the map, and what it is told to do."""
        wanted = (round(at[0], 1), round(at[1], 1), command)
        if wanted != self._shown:
            self._shown = wanted
            self._publisher.publish(
                MarkerArray(markers=[*self._tasks(command), *self._own(at, command)])
            )

    def _tasks(self, command: Command) -> list[Marker]:
        """Return a box and a name for each task of the mission; its own one is coloured."""
        markers = []
        for number, task in enumerate(self._mission.tasks):
            colour = GREY
            if task.key == command.task:
                colour = GREEN if command.serve else BLUE
            x, y = metres_of(self._mission.source.world, (task.x, task.y))
            box = self._marker(2 * number, Marker.CUBE, (x, y, 0.05), colour)
            box.scale.x = box.scale.y = 0.4
            box.scale.z = 0.1
            markers += [box, self._text(2 * number + 1, task.name, x, y)]
        return markers

    def _own(self, at: tuple[float, float], command: Command) -> list[Marker]:
        """Return the robot's name, and the line to where it heads for or what removes it."""
        line = self._marker(WAY, Marker.LINE_STRIP, (0.0, 0.0, 0.1), BLUE)
        line.scale.x = 0.05
        if command.place is None:
            line.action = Marker.DELETE
        else:
            goal = metres_of(self._mission.source.world, command.place)
            line.points = [Point(x=x, y=y) for x, y in (at, goal)]
        return [self._text(ROBOT, self._name, *at), line]

    def _text(self, number: int, text: str, x: float, y: float) -> Marker:
        marker = self._marker(number, Marker.TEXT_VIEW_FACING, (x, y, 0.6), (0.1, 0.1, 0.1))
        marker.text = text
        marker.scale.z = 0.3
        return marker

    def _marker(
        self, number: int, kind: int, at: tuple[float, float, float], colour: tuple[float, ...]
    ) -> Marker:
        marker = Marker(ns=self._name, id=number, type=kind, action=Marker.ADD)
        marker.header.frame_id, marker.header.stamp = self._frame, Time()  # the newest frame
        marker.pose.position.x, marker.pose.position.y, marker.pose.position.z = at
        marker.pose.orientation.w = 1.0
        marker.color.r, marker.color.g, marker.color.b = colour
        marker.color.a = 1.0
        return marker
