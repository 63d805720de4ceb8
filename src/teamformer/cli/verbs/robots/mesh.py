"""What the verbs of `fleet` share: the mission as agents have it, and how to speak to them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from teamformer.base.extras import require
from teamformer.files.mission_files import read_mission
from teamformer.mission.checks.rules import rules_of_simulated_missions

if TYPE_CHECKING:
    from teamformer.fleet.fleet_mission import FleetMission
    from teamformer.fleet.messages import Post
    from teamformer.fleet.transports.zenoh_mesh import ZenohTransport


@dataclass(frozen=True)
class FleetAt:
    """Where a running fleet is heard: the endpoint of one of its agents, and the fleet's keys."""

    endpoint: str
    keys: Path | None = None


def read_fleet_mission(path: Path, *libraries: str) -> FleetMission:
    """Read a mission as a fleet's agents have it.

    Raises `TeamformerError` for what is wrong with the file, and if msgspec or one of the
    `libraries` is not installed.
    """
    require("fleet", "msgspec", *libraries)
    from teamformer.fleet.fleet_mission import FleetMission

    mission = read_mission(path, rules_of_simulated_missions)
    return FleetMission(mission, mission.seconds_a_step)


def check_method(name: str) -> None:
    """Refuse a method by which no robot could decide."""
    from teamformer.fleet.methods import policy_of

    policy_of(name, 0)


def dial_as_operator(mission: FleetMission, fleet: FleetAt) -> tuple[ZenohTransport, Post]:
    """Return a transport to a running fleet, to be closed, and what seals and opens its messages.

    Raises `TeamformerError` for keys and endpoints that cannot be.
    """
    from teamformer.fleet.messages import OPERATOR, Post
    from teamformer.fleet.transports.keys import read_keys
    from teamformer.fleet.transports.zenoh_mesh import ZenohTransport

    keys = read_keys(fleet.keys)
    keys.check([fleet.endpoint])
    signatures = keys.signatures(mission, OPERATOR)
    post = Post(mission.number, mission.robots, keys.secret, signatures)
    transport = ZenohTransport(  # last: a process ends only once it is closed
        mission.number, OPERATOR, None, [fleet.endpoint], certificates=keys.certificates
    )
    return transport, post
