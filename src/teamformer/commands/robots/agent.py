"""`teamformer agent`: one robot's mind."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from teamformer.commands.robots.rehearse import require_extra, signatures_in
from teamformer.errors import TeamformerError
from teamformer.mission.rules import rules_of_simulated_missions
from teamformer.model import Scenario
from teamformer.scenarios.files import read_scenario


@dataclass(frozen=True)
class Options:
    """What the command line says."""

    robot: str
    body: str
    listen: str | None
    connect: tuple[str, ...]
    key: Path | None
    tls: Path | None
    facts: Path | None
    plan: Path | None
    pace: float
    drop: float
    method: str = "plan"
    sign: Path | None = None


def agent(path: Path, options: Options) -> int:
    """Run the mind of a robot until it is told to end; return the exit status."""
    require_extra("zenoh")
    from teamformer.fleet.agent.planning import FleetPlan, first_plan
    from teamformer.fleet.methods import planner_of, policy_of
    from teamformer.fleet.mission import Mission, seconds_a_step
    from teamformer.fleet.process.facts_file import FactsFile
    from teamformer.fleet.process.loop import AgentProcess
    from teamformer.fleet.transports.transport import (
        check_endpoints,
        read_certificates,
        read_secret,
    )
    from teamformer.fleet.transports.zenoh_mesh import ZenohTransport

    scenario = read_scenario(path, rules_of_simulated_missions)
    robot = _number_of(scenario, options.robot)
    secret, certificates = read_secret(options.key), read_certificates(options.tls)
    endpoints = [*([options.listen] if options.listen else []), *options.connect]
    if not endpoints:
        raise TeamformerError(
            "the agent has no way to the others", "add --listen ENDPOINT or --connect ENDPOINT"
        )
    check_endpoints(endpoints, secret, certificates)
    mission = Mission(scenario, seconds_a_step(scenario, options.pace))
    signatures = signatures_in(options.sign, mission, robot)
    facts = FactsFile(options.facts, mission.number, robot) if options.facts else None
    if facts is not None:
        facts.read()  # a broken file is told before anything moves
    if options.plan is not None:
        plan = FleetPlan(_read_plan(options.plan))
    else:
        plan = first_plan(mission, planner_of(options.method))
    policy_of(options.method, robot)  # an unknown method is told before anything moves
    make_body = _body_maker(options.body, mission, robot)
    ends = (options.listen, options.connect)
    transport = ZenohTransport(mission.number, robot, *ends, options.drop, certificates)
    try:
        process = AgentProcess(
            mission,
            robot,
            plan,
            transport,
            make_body(transport),
            secret,
            facts,
            signatures,
            options.method,
        )
        print(f"agent {options.robot} of mission {mission.number:x}", file=sys.stderr, flush=True)
        return process.run()
    finally:
        transport.close()


def _number_of(scenario: Scenario, name: str) -> int:
    names = [robot.name for robot in scenario.robots]
    if name not in names:
        shown = ", ".join(names[:12]) + (", ..." if len(names) > 12 else "")
        raise TeamformerError(f"there is no robot '{name}' in the mission", f"there are {shown}")
    return names.index(name)


def _read_plan(path: Path) -> Any:
    from msgspec import DecodeError, ValidationError
    from msgspec.msgpack import decode

    from teamformer.fleet.messages import PlanNote

    try:
        return decode(path.read_bytes(), type=PlanNote)
    except (OSError, DecodeError, ValidationError) as error:
        raise TeamformerError(f"{path}: this is no plan: {error}", "leave --plan out") from None


def _body_maker(name: str, mission: Any, robot: int) -> Callable[[Any], Any]:
    """Return what makes the body once there is a transport; the simulated one needs it."""
    kind, _, rest = name.partition(":")
    if kind == "sim":
        return lambda transport: _simulated(transport, robot)
    if kind == "vda5050":
        require_extra("paho")
        from teamformer.fleet.bodies.vda5050 import Vda5050Body

        return lambda _: Vda5050Body(rest, mission, robot)
    from teamformer.fleet.bodies.own import OwnBody

    own = OwnBody(name, mission, robot)
    return lambda _: own


def _simulated(transport: Any, robot: int) -> Any:
    from teamformer.fleet.bodies.remote import RemoteBody

    body = RemoteBody(transport, robot)
    transport.listen_to_body(f"reports/{robot}")
    return _Fed(body, transport)


class _Fed:
    """A simulated body whose reports are taken from the network when it is asked."""

    def __init__(self, body: Any, transport: Any) -> None:
        self._body, self._transport = body, transport

    def command(self, command: Any) -> None:
        self._body.command(command)

    def report(self) -> Any:
        for data in self._transport.receive_body():
            self._body.take(data)
        return self._body.report()

    def close(self) -> None:
        self._body.close()
