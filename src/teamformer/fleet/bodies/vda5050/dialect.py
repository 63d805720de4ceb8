"""What versions of VDA5050 say differently."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

VERSIONS = ("2.0.0", "2.1.0", "3.0.0")
"""Versions of VDA5050 that a vehicle may speak; the first unless the address names another."""


class Dialect(NamedTuple):
    """The words of a version, and the values where they differ."""

    position: str  # where a vehicle is
    is_localized: str  # whether that is known
    action_states: str  # of instant actions
    result: str  # what came of an action, in words
    action_lists: tuple[str, ...]  # names of the list of instant actions
    blocking: str  # how a service blocks other actions
    deviation: Mapping[str, Any]  # by a metre from the node that a vehicle stands at
    speed: str  # at most, on an edge
    battery: tuple[str, str]  # where a state says how full the battery is, in percent


DIALECTS = {
    # The text of 2.0 calls the list `actions`, its first schema `instantActions`; the deviation
    # ends in `XY` and in `Xy` there. Vehicles check for one or the other.
    "2": Dialect(
        position="agvPosition",
        is_localized="positionInitialized",
        action_states="actionStates",
        result="resultDescription",
        action_lists=("actions", "instantActions"),
        blocking="HARD",
        deviation={"allowedDeviationXY": 1.0, "allowedDeviationXy": 1.0},
        speed="maxSpeed",
        battery=("batteryState", "batteryCharge"),
    ),
    "3": Dialect(
        position="mobileRobotPosition",
        is_localized="localized",
        action_states="instantActionStates",
        result="actionResult",
        action_lists=("actions",),
        blocking="NONE",
        deviation={"allowedDeviationXY": {"a": 1.0, "b": 1.0, "theta": 0.0}},
        speed="maximumSpeed",
        battery=("powerSupply", "stateOfCharge"),
    ),
}
"""By the first number of a version."""
