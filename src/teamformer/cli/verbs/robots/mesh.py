"""What the verbs of `fleet` share: the mission as agents have it, and how to speak to them."""

from __future__ import annotations

import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from teamformer.base.extras import require
from teamformer.cli.terminal.console import out, say
from teamformer.files.mission_files import Finder, read_mission
from teamformer.mission.checks.rules import rules_of_fleets

if TYPE_CHECKING:
    from teamformer.fleet.fleet_mission import FleetMission
    from teamformer.fleet.messages import Post
    from teamformer.fleet.operator import Operator
    from teamformer.fleet.transports.zenoh_mesh import ZenohTransport


@dataclass(frozen=True)
class FleetAt:
    """Where a running fleet is heard: the endpoint of one of its agents, and the fleet's keys."""

    endpoint: str
    keys: Path | None = None


PATIENCE = 20.0
"""Seconds until an operator gives up."""

SILENCE = 2.0
"""Seconds without an answer after which that is said."""


def read_fleet_mission(
    path: Path, *libraries: str, refuse: Finder = rules_of_fleets
) -> FleetMission:
    """Read a mission as a fleet's agents have it, unless there is something to `refuse`.

    Raises `TeamformerError` for what is wrong with the file, and if msgspec or one of the
    `libraries` is not installed.
    """
    require("fleet", "msgspec", *libraries)
    from teamformer.fleet.fleet_mission import FleetMission

    mission = read_mission(path, refuse)
    return FleetMission(mission, mission.seconds_a_step)


def check_method(name: str, mission: FleetMission) -> None:
    """Refuse a method by which no robot could decide, or not in the mission's time."""
    from teamformer.fleet.methods import PLAN, policy_of
    from teamformer.trials.continuous_trial import coordinator_of

    policy_of(name, 0)
    if name != PLAN and mission.source.time == "continuous":
        from teamformer.methods.by_name import load_method

        coordinator_of(load_method(name), mission.source)


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


def have_accepted(operator: Operator, mission: FleetMission, fleet: FleetAt) -> int:
    """Say what an operator has to say until a running fleet accepts it; tell how that ended.

    Returns 0 if it was accepted, else 1.
    """
    _say_until_accepted(operator, mission, fleet)
    robots, name = mission.source.robots, operator.task.name
    what = "called off" if operator.calls_off else "accepted"
    holders = ", ".join(robots[robot].name for robot in sorted(operator.holders))
    if operator.is_accepted:
        out.print(f"{name}: {what}, held by {holders}", markup=False)
        return 0
    have = f"only {holders} hold that" if holders else "no robot answered"
    say(f"{name}: not {what}, {have}; {operator.needed} must; it may still be done")
    if not holders:
        say("hint: MISSION and --keys have to be the fleet's")
    return 1


def _say_until_accepted(operator: Operator, mission: FleetMission, fleet: FleetAt) -> None:
    """Say what an operator has to say until it is accepted or patience ends."""
    from teamformer.fleet.messages import OPERATOR
    from teamformer.fleet.operator import AGAIN

    transport, post = dial_as_operator(mission, fleet)
    begun, told = time.monotonic(), frozenset[int]()
    is_silence_told = False
    try:
        while not operator.is_accepted and time.monotonic() < begun + PATIENCE:
            notice = operator.offer()
            transport.send(notice.to, post.seal(OPERATOR, notice))
            for data in transport.receive(AGAIN):
                message, _ = post.judge(data)
                if message is not None:
                    operator.hear(message)
            new, told = operator.holders - told, frozenset(operator.holders)
            if new:
                names = ", ".join(mission.source.robots[robot].name for robot in sorted(new))
                say(f"heard by {names}")
            if not told and not is_silence_told and time.monotonic() > begun + SILENCE:
                is_silence_told = True
                say(f"no robot has answered yet; trying for {PATIENCE:.0f} s")
    finally:
        transport.close()
