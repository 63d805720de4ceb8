"""A robot in a ROS 2 graph: takes `goal_pose`, drives there, tells its odometry and its status.

`python ros_robot.py NAMESPACE X Y SPEED FILE`; each goal that it takes is a line of the file.
"""

from __future__ import annotations

import math
import sys
import uuid
from contextlib import suppress
from pathlib import Path

import rclpy
from action_msgs.msg import GoalStatus, GoalStatusArray
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Odometry
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile

TICK = 0.05  # seconds


class Robot(Node):
    """Drives straight to its newest goal, and stops `short` metres before it, as Nav2 may."""

    def __init__(self, namespace: str, at: tuple[float, float], speed: float, file: Path) -> None:
        super().__init__("robot", namespace=namespace)
        self.at, self.speed, self.file = at, speed, file
        self.short = 0.2
        self.goal: tuple[float, float] | None = None
        self.status = GoalStatus()
        self.create_subscription(PoseStamped, "goal_pose", self.take, 10)
        self.odometry = self.create_publisher(Odometry, "odom", 10)
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.statuses = self.create_publisher(
            GoalStatusArray, "navigate_to_pose/_action/status", latched
        )
        self.create_timer(TICK, self.drive)

    def take(self, pose: PoseStamped) -> None:
        at = pose.pose.position
        self.goal = (at.x, at.y)
        with self.file.open("a") as lines:
            lines.write(f"{pose.header.frame_id} {at.x:g} {at.y:g}\n")
        self.status = GoalStatus()
        self.status.goal_info.goal_id.uuid = list(uuid.uuid4().bytes)
        self.status.goal_info.stamp = self.get_clock().now().to_msg()
        self.tell(GoalStatus.STATUS_EXECUTING)

    def tell(self, status: int) -> None:
        self.status.status = status
        self.statuses.publish(GoalStatusArray(status_list=[self.status]))

    def drive(self) -> None:
        if self.goal is not None:
            left = math.dist(self.at, self.goal)
            if left <= self.short:
                self.goal = None
                self.tell(GoalStatus.STATUS_SUCCEEDED)
            else:
                part = min(self.speed * TICK, left) / left
                (x, y), (to_x, to_y) = self.at, self.goal
                self.at = (x + part * (to_x - x), y + part * (to_y - y))
        message = Odometry()
        message.header.frame_id = "map"
        message.header.stamp = self.get_clock().now().to_msg()
        message.pose.pose.position.x, message.pose.pose.position.y = self.at
        self.odometry.publish(message)


def main() -> None:
    namespace, x, y, speed, file = sys.argv[1:]
    rclpy.init()
    robot = Robot(namespace, (float(x), float(y)), float(speed), Path(file))
    with suppress(KeyboardInterrupt, ExternalShutdownException):
        rclpy.spin(robot)


if __name__ == "__main__":
    main()
