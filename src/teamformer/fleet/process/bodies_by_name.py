"""Bodies by name: those that packages bring, and a class of a user's own."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

from teamformer.base.entry_points import Brought, find_brought, names_of
from teamformer.base.errors import TeamformerError
from teamformer.base.own_code import load_own
from teamformer.fleet.bodies.body import Body
from teamformer.fleet.bodies.own import OwnBody

if TYPE_CHECKING:
    from teamformer.fleet.bodies.remote import Line
    from teamformer.fleet.fleet_mission import FleetMission

MakeBody = Callable[["FleetMission", int, "Line"], Body]
"""From the mission, the number of the robot, and the line to what is simulated elsewhere."""


def body_maker(name: str) -> MakeBody:
    """Return what makes the body that `--body` names, as NAME, NAME:ADDRESS or module:Class.

    A class of one's own is called with the mission and the robot; what a package brings also with
    the address and the line. Raises `TeamformerError` for a name that is none, and for what cannot
    be imported.
    """
    kind, _, address = name.partition(":")
    if (found := find_brought("body", kind)) is not None:
        return _maker_of(found, name, address)
    if not all(part.isidentifier() for part in (*kind.split("."), address)):
        hint = f"use NAME or NAME:ADDRESS of {', '.join(names_of('body'))}, or module:Class"
        raise TeamformerError(f"there is no body '{name}'", hint)
    make = load_own(name, "body")
    return lambda mission, robot, _: OwnBody(name, partial(make, mission, robot))


def _maker_of(found: Brought, name: str, address: str) -> MakeBody:
    make: Any = found.load()
    if found.is_ours:
        return lambda mission, robot, line: make(mission, robot, address, line)
    return lambda mission, robot, line: OwnBody(name, partial(make, mission, robot, address, line))
