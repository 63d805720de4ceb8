"""Two ways to send a robot off: Nav2's action, and the topic `goal_pose`."""

from __future__ import annotations

import math
from collections.abc import Callable
from enum import Enum
from typing import Any, Protocol

from action_msgs.msg import GoalStatus, GoalStatusArray
from geometry_msgs.msg import PoseStamped
from rclpy.action import ActionClient
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile

ACTION = "navigate_to_pose"
GOAL = "goal_pose"


class GoalState(Enum):
    """How far a robot is with its newest goal."""

    UNKNOWN = "unknown"
    GOING = "going"
    ENDED = "ended"
    FAILED = "failed"


class GoalSender(Protocol):
    """Sends one robot off; a new goal takes the place of the one before."""

    state: GoalState

    def go(self, pose: PoseStamped) -> None:
        """Send the robot to a pose of the map."""

    def stop(self, here: PoseStamped) -> None:
        """Have it stop; `here` is where it is."""


def pose_at(frame: str, x: float, y: float, yaw: float, stamp: Any) -> PoseStamped:
    """Return a pose on the ground: metres in a frame, `yaw` in radians."""
    pose = PoseStamped()
    pose.header.frame_id, pose.header.stamp = frame, stamp
    pose.pose.position.x, pose.pose.position.y = x, y
    pose.pose.orientation.z, pose.pose.orientation.w = math.sin(yaw / 2), math.cos(yaw / 2)
    return pose


class ByTopic:
    """Publishes goals, and hears how far the robot is from the action's status, if there is one."""

    def __init__(self, node: Node) -> None:
        self.state = GoalState.UNKNOWN
        self._publisher = node.create_publisher(PoseStamped, GOAL, 10)
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        node.create_subscription(
            GoalStatusArray, f"{ACTION}/_action/status", self._on_status, latched
        )
        self._newest = self._before = b""

    def go(self, pose: PoseStamped) -> None:
        """Publish a goal."""
        self.state, self._before = GoalState.UNKNOWN, self._newest
        self._publisher.publish(pose)

    def stop(self, here: PoseStamped) -> None:
        """Send the robot to where it is."""
        self.go(here)

    def _on_status(self, heard: GoalStatusArray) -> None:
        """Take in the status of the newest goal, unless that is one from before the last `go`."""
        if not heard.status_list:
            return
        newest = max(heard.status_list, key=_stamp)
        self._newest = bytes(newest.goal_info.goal_id.uuid)
        if self._newest != self._before:
            self.state = _state_of(newest.status)


class ByAction:
    """Sends goals to an action server; `goal_of` makes the action's goal of a pose."""

    def __init__(
        self, node: Node, kind: Any, goal_of: Callable[[PoseStamped], Any], name: str = ACTION
    ) -> None:
        self.state = GoalState.UNKNOWN
        self.client = ActionClient(node, kind, name)
        self._goal_of = goal_of
        self._count = 0  # of goals: what comes back of an older one is left
        self._handle: Any = None

    def go(self, pose: PoseStamped) -> None:
        """Send a goal, and cancel the one before; it has failed if there is no server."""
        self._cancel()
        self._count += 1
        number = self._count
        if not self.client.server_is_ready():
            self.state = GoalState.FAILED
            return
        self.state = GoalState.UNKNOWN
        sent = self.client.send_goal_async(self._goal_of(pose))
        sent.add_done_callback(lambda future: self._on_answer(number, future.result()))

    def stop(self, here: PoseStamped) -> None:
        """Cancel the goal."""
        self._cancel()
        self._count += 1
        self.state = GoalState.ENDED

    def _cancel(self) -> None:
        if self._handle is not None:
            self._handle.cancel_goal_async()
            self._handle = None

    def _on_answer(self, number: int, handle: Any) -> None:
        """Follow an accepted goal, or cancel it if another was sent meanwhile."""
        if number != self._count:
            if handle.accepted:
                handle.cancel_goal_async()
        elif handle.accepted:
            self.state, self._handle = GoalState.GOING, handle
            handle.get_result_async().add_done_callback(
                lambda future: self._on_result(number, future.result().status)
            )
        else:
            self.state = GoalState.FAILED

    def _on_result(self, number: int, status: int) -> None:
        """Take in how a goal ended; only the status is read, since results differ by version."""
        if number == self._count:
            self.state, self._handle = _state_of(status), None


def _state_of(status: int) -> GoalState:
    if status == GoalStatus.STATUS_SUCCEEDED:
        return GoalState.ENDED
    has_failed = status in (GoalStatus.STATUS_ABORTED, GoalStatus.STATUS_CANCELED)
    return GoalState.FAILED if has_failed else GoalState.GOING


def _stamp(status: GoalStatus) -> tuple[int, int]:
    return status.goal_info.stamp.sec, status.goal_info.stamp.nanosec
