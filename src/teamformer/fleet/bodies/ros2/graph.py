"""A node of our own in the ROS graph, which a thread spins, and where the robot says that it is."""

from __future__ import annotations

import threading
import time
from importlib.util import find_spec
from typing import Any

import rclpy
from geometry_msgs.msg import PoseWithCovarianceStamped
from nav_msgs.msg import Odometry
from rclpy.context import Context
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from rclpy.signals import SignalHandlerOptions

from teamformer.base.errors import TeamformerError
from teamformer.fleet.bodies.body import charge_of
from teamformer.fleet.bodies.ros2.address import RosAddress

FIRST = 10.0
"""Seconds that a robot has to say for the first time where it is."""

STALE = 3.0
"""Seconds after which odometry says nothing about the present."""


class RosNode:
    """A node in a robot's namespace, in a context of its own. Signals stay with the process."""

    def __init__(self, namespace: str) -> None:
        self._context = Context()
        rclpy.init(context=self._context, signal_handler_options=SignalHandlerOptions.NO)
        self.node = Node("teamformer", namespace=namespace, context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)
        self._thread = threading.Thread(target=self._spin, daemon=True)
        self._thread.start()

    def _spin(self) -> None:
        try:
            self._executor.spin()
        except ExternalShutdownException:
            return

    def close(self) -> None:
        """Leave the graph."""
        self._executor.shutdown()
        self._thread.join(2.0)
        self.node.destroy_node()
        self._context.try_shutdown()


class Whereabouts:
    """Hears where a robot is: its odometry, or the pose that a localiser publishes."""

    def __init__(self, graph: RosNode, address: RosAddress) -> None:
        self._graph = graph
        self.topic = address.topic(address.pose or address.odom)
        self.count = 0
        self._is_odometry = not address.pose
        self._newest: tuple[float, float] | None = None
        self._heard = float("-inf")
        if self._is_odometry:
            graph.node.create_subscription(
                Odometry, self.topic, self._take, qos_profile_sensor_data
            )
        else:  # published when it changes: the last one is kept for who comes later
            latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
            graph.node.create_subscription(
                PoseWithCovarianceStamped, self.topic, self._take, latched
            )

    def newest(self) -> tuple[float, float] | None:
        """Return metres of the map; None before the first, and if odometry has become silent."""
        is_stale = self._is_odometry and time.monotonic() - self._heard > STALE
        return None if is_stale else self._newest

    def wait(self, seconds: float = FIRST) -> None:
        """Wait until the robot has said where it is; raise `TeamformerError` if it does not."""
        deadline = time.monotonic() + seconds
        while self._newest is None:
            if time.monotonic() > deadline:
                raise TeamformerError(f"no {self._what} from {self.topic} within {seconds:g} s",
                                      self._hint())  # fmt: skip
            time.sleep(0.05)

    @property
    def _what(self) -> str:
        return "odometry" if self._is_odometry else "pose"

    def _hint(self) -> str:
        """Say which topics of that kind there are."""
        kind = "nav_msgs/msg/Odometry"
        if not self._is_odometry:
            kind = "geometry_msgs/msg/PoseWithCovarianceStamped"
        node = self._graph.node
        others = sorted(
            name
            for name, kinds in node.get_topic_names_and_types()
            if kind in kinds and node.get_publishers_info_by_topic(name)
        )
        if others:
            return (
                f"there is {', '.join(others)}; name another with --body nav2:NAMESPACE?odom=TOPIC"
            )
        return "is the robot up, and does it have the same ROS_DOMAIN_ID?"

    def _take(self, message: Any) -> None:
        at = message.pose.pose.position
        if at.x == at.x and at.y == at.y:
            self._newest, self._heard = (at.x, at.y), time.monotonic()
            self.count += 1


class BatteryGauge:
    """Hears how full a robot's battery is, if it says so; `charge` is from 0 to 1.

    Nothing is heard where `sensor_msgs` is not installed.
    """

    def __init__(self, graph: RosNode, address: RosAddress) -> None:
        self.charge: float | None = None
        if find_spec("sensor_msgs") is None:
            return
        from sensor_msgs.msg import BatteryState

        topic = address.topic(address.battery)
        graph.node.create_subscription(BatteryState, topic, self._take, qos_profile_sensor_data)

    def _take(self, message: Any) -> None:
        share = message.percentage
        if share == share:  # else it was not measured
            self.charge = charge_of(share)
