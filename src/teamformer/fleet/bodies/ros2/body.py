"""A robot that Nav2, or anything that takes `goal_pose`, drives in a ROS 2 graph."""

from __future__ import annotations

import json
import math
import time
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from geometry_msgs.msg import PoseStamped
from std_msgs.msg import String

from teamformer.base.errors import TeamformerError
from teamformer.fleet.bodies.body import Command, Report
from teamformer.fleet.bodies.ros2.address import RosAddress
from teamformer.fleet.bodies.ros2.coordinates import metres_of, place_of
from teamformer.fleet.bodies.ros2.goals import (
    ACTION,
    GOAL,
    ByAction,
    ByTopic,
    GoalSender,
    GoalState,
    pose_at,
)
from teamformer.fleet.bodies.ros2.graph import BatteryGauge, RosNode, Whereabouts
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.saying import say
from teamformer.mission.parts.grid import Place

if TYPE_CHECKING:
    from teamformer.fleet.bodies.ros2.markers import Markers

AGAIN = 2.0
"""Seconds until a goal that the robot does not pursue is sent once more."""

MOVED = 0.1
"""Metres that show that a robot pursues its goal."""

SERVER = 2.0
"""Seconds to look for Nav2's action server; without one, goals are published."""


class Nav2Body:
    """One robot of a ROS graph.

    Raises `TeamformerError` if the robot does not say where it is, or is to carry loads.
    """

    def __init__(self, address: RosAddress, mission: FleetMission, robot: int) -> None:
        for task in mission.tasks:
            if task.to is not None:
                raise TeamformerError(
                    f"--body nav2 cannot take up loads, and task '{task.name}' has one",
                    "drop to and unload, or write a body of your own: docs/how-to/robots.md",
                )
        self._address, self._world = address, mission.source.world
        self._name = mission.source.robots[robot].name
        self._names = {task.key: task.name for task in mission.tasks}
        self._command = Command()
        self._sent = float("-inf")  # when the goal was last sent, or the robot last moved
        self._from = (0.0, 0.0)  # where it was then
        self._sent_leg = 0
        self._arrived: Place | None = None
        self._began: float | None = None  # when it began to serve
        self._is_silent = False
        self._graph = RosNode(address.namespace)
        try:
            self._where = Whereabouts(self._graph, address)
            self._where.wait()
            self._battery = BatteryGauge(self._graph, address)
            self._goals = self._way_to_go()
            self._service = ServeCaller(self._graph, address) if address.serve else None
            self._markers = _markers(self._graph, mission, robot, address.frame)
        except BaseException:
            self._graph.close()
            raise

    def command(self, command: Command) -> None:
        """Take up a command, and see to it that the robot pursues it."""
        if command.serve != self._command.serve or command.task != self._command.task:
            self._began = time.monotonic() if command.serve else None
            if self._service is not None and command.serve:
                self._service.forget(self._task(command))
        self._command = command
        self._pursue()

    def report(self) -> Report | None:
        """Return where the robot is; None while nothing is heard of it."""
        at = self._where.newest()
        if at is None:
            if not self._is_silent:
                self._say(f"nothing is heard from {self._where.topic} any more")
            self._is_silent = True
            return None
        if self._is_silent:
            self._say(f"{self._where.topic} is heard again")
        self._is_silent = False
        self._pursue()
        if self._markers is not None:
            self._markers.show(at, self._command)
        x, y = self._place(at)
        report = Report(x, y, self._command.leg, number=self._where.count)
        return report._replace(has_served=self._has_served(), charge=self._battery.charge)

    def close(self) -> None:
        """Stop the robot and leave the graph."""
        at = self._where.newest()
        if at is not None and self._arrived is None:
            self._goals.stop(self._pose(at, 0.0))
            time.sleep(0.2)  # until that is out
        self._graph.close()

    def _way_to_go(self) -> GoalSender:
        """Return Nav2's action where its types and its server are there, else the topic."""
        try:
            from nav2_msgs.action import NavigateToPose
        except ImportError:
            why = "nav2_msgs is not installed"
        else:
            actions = ByAction(
                self._graph.node, NavigateToPose, lambda pose: NavigateToPose.Goal(pose=pose)
            )
            if actions.client.wait_for_server(SERVER):
                self._say(f"sends goals to the action {self._address.topic(ACTION)}")
                return actions
            why = f"nobody serves the action {ACTION}"
        self._say(f"publishes goals on {self._address.topic(GOAL)}, since {why}")
        return ByTopic(self._graph.node)

    def _pursue(self) -> None:
        """Send the robot off, or once more if it does not go; have it stop if it is to stay."""
        at, goal = self._where.newest(), self._command.place
        if at is None:
            return
        self._note_arrival(at, goal)
        is_new = self._command.leg != self._sent_leg
        if goal is None:
            if is_new and self._arrived is None:
                self._goals.stop(self._pose(at, 0.0))
            self._sent_leg = self._command.leg
        elif self._arrived == goal:
            self._sent_leg = self._command.leg
        elif is_new or self._is_to_send_again(at):
            if not is_new and self._goals.state == GoalState.FAILED:
                self._say(f"has given up its way to {goal[0]:g}, {goal[1]:g}; it is sent again")
            self._sent, self._from, self._sent_leg = time.monotonic(), at, self._command.leg
            x, y = metres_of(self._world, goal)
            self._goals.go(self._pose((x, y), math.atan2(y - at[1], x - at[0])))

    def _note_arrival(self, at: tuple[float, float], goal: Place | None) -> None:
        """Note that it is at its goal; it stays there until it is sent off or is driven away."""
        if goal is not None and math.dist(at, metres_of(self._world, goal)) <= self._address.radius:
            self._arrived = goal
        elif self._arrived is not None:
            is_away = math.dist(at, metres_of(self._world, self._arrived)) > self._address.radius
            if is_away or goal is not None:
                self._arrived = None

    def _is_to_send_again(self, at: tuple[float, float]) -> bool:
        """Say whether the robot has failed, or does not move and nothing says that it will."""
        now = time.monotonic()
        if math.dist(at, self._from) > MOVED:
            self._sent, self._from = now, at
        has_stopped = self._goals.state in (GoalState.FAILED, GoalState.ENDED, GoalState.UNKNOWN)
        return has_stopped and now - self._sent > AGAIN

    def _place(self, at: tuple[float, float]) -> Place:
        return self._arrived if self._arrived is not None else place_of(self._world, *at)

    def _has_served(self) -> bool:
        """Say whether it has served for as long as the task takes, or its robot says that."""
        command = self._command
        if not command.serve or self._began is None:
            return False
        if self._service is None:
            return time.monotonic() - self._began >= command.duration
        return self._service.is_done(self._task(command), command.team, command.duration)

    def _task(self, command: Command) -> str:
        return self._names.get(command.task, str(command.task))

    def _pose(self, at: tuple[float, float], yaw: float) -> PoseStamped:
        stamp = self._graph.node.get_clock().now().to_msg()
        return pose_at(self._address.frame, *at, yaw, stamp)

    def _say(self, message: str) -> None:
        say(self._name, message)


def _markers(graph: RosNode, mission: FleetMission, robot: int, frame: str) -> Markers | None:
    """Return what shows the mission in RViz; None where its messages are not installed."""
    if find_spec("visualization_msgs") is None:
        return None
    from teamformer.fleet.bodies.ros2.markers import Markers

    return Markers(graph.node, mission, robot, frame)


class ServeCaller:
    """Tells a robot to serve, again and again, until it says on `TOPIC/done` that it has."""

    def __init__(self, graph: RosNode, address: RosAddress) -> None:
        topic = address.topic(address.serve)
        self._publisher = graph.node.create_publisher(String, topic, 10)
        graph.node.create_subscription(String, f"{topic}/done", self._take, 10)
        self._done: set[str] = set()
        self._sent = float("-inf")

    def forget(self, task: str) -> None:
        """Forget that the robot has served a task: it is to do so again."""
        self._done.discard(task)

    def is_done(self, task: str, team: int, duration: float) -> bool:
        """Say whether the robot has served a task; tell it to if it has not."""
        now = time.monotonic()
        if task not in self._done and now - self._sent > AGAIN:
            self._sent = now
            order = {"task": task, "team": team, "duration": duration}
            self._publisher.publish(String(data=json.dumps(order)))
        return task in self._done

    def _take(self, message: Any) -> None:
        self._done.add(message.data)
