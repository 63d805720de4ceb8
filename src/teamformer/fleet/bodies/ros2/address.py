"""What `--body nav2:...` names: a robot's namespace, and the topics and lengths to use there."""

from __future__ import annotations

import re
from dataclasses import dataclass, fields, replace
from typing import Any
from urllib.parse import parse_qsl

from teamformer.base.errors import TeamformerError

NAME = re.compile(r"/?[A-Za-z_]\w*(/[A-Za-z_]\w*)*", re.ASCII)
HINT = "write nav2:NAMESPACE?frame=map&odom=TOPIC&radius=METRES; all of it may be left out"


@dataclass(frozen=True)
class RosAddress:
    """A robot in a ROS graph. Topics without a leading slash are inside its namespace.

    `pose` names a topic of PoseWithCovarianceStamped, such as `amcl_pose`, to use in place of the
    odometry of `odom`. Within `radius` metres of its goal a robot counts as there. `serve` names
    the topic on which it is told to serve; without one, it serves by standing there. `battery`
    names a topic of BatteryState.
    """

    namespace: str
    frame: str = "map"
    odom: str = "odom"
    pose: str = ""
    radius: float = 0.5
    serve: str = ""
    battery: str = "battery_state"

    def topic(self, name: str) -> str:
        """Return a topic's full name."""
        return name if name.startswith("/") else f"{self.namespace.rstrip('/')}/{name}"


def read_address(text: str, robot: str) -> RosAddress:
    """Return what `NAMESPACE?key=value&...` names; the namespace is the robot's name by default.

    Raises `TeamformerError` for names that ROS does not allow, unknown keys and bad lengths.
    """
    named, _, query = text.partition("?")
    namespace = named or robot
    if namespace != "/" and not NAME.fullmatch(namespace):
        which = f"'{namespace}'" if named else f"the robot's name '{namespace}'"
        raise TeamformerError(f"--body nav2: {which} is no ROS namespace", HINT)
    address = RosAddress("/" + namespace.strip("/"))
    known = [field.name for field in fields(RosAddress)][1:]
    for key, value in parse_qsl(query, keep_blank_values=True):
        if key not in known:
            raise TeamformerError(f"--body nav2 has no '{key}'", f"it has {', '.join(known)}")
        address = replace(address, **{key: _checked(key, value)})
    return address


def _checked(key: str, value: str) -> Any:
    if key == "radius":
        try:
            radius = float(value)
        except ValueError:
            radius = -1.0
        if not 0 < radius < float("inf"):
            raise TeamformerError(f"--body nav2: radius '{value}' is no length above 0", HINT)
        return radius
    if not NAME.fullmatch(value):
        raise TeamformerError(f"--body nav2: {key} '{value}' is no ROS name", HINT)
    return value
