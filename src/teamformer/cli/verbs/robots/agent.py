"""`teamformer fleet agent`: one robot's mind."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from teamformer.base.errors import TeamformerError
from teamformer.cli.terminal.console import say
from teamformer.cli.verbs.robots.mesh import check_method, read_fleet_mission
from teamformer.mission.model import Mission


@dataclass(frozen=True)
class AgentOptions:
    """What the command line says."""

    robot: str
    body: str
    listen: str | None
    connect: tuple[str, ...]
    keys: Path | None
    facts: Path | None
    method: str = "plan"


def agent(path: Path, options: AgentOptions) -> int:
    """Run the mind of a robot until it is told to end; return the exit status."""
    mission = read_fleet_mission(path, "zenoh")
    from teamformer.fleet.agent.planning import first_plan
    from teamformer.fleet.methods import planner_of
    from teamformer.fleet.process.bodies_by_name import body_maker
    from teamformer.fleet.process.facts_file import FactsFile
    from teamformer.fleet.process.loop import AgentProcess
    from teamformer.fleet.transports.keys import read_keys
    from teamformer.fleet.transports.zenoh_mesh import ZenohTransport

    robot = _number_of(mission.source, options.robot)
    keys = read_keys(options.keys)
    endpoints = [*([options.listen] if options.listen else []), *options.connect]
    if not endpoints:
        raise TeamformerError(
            "the agent has no way to the others", "add --listen ENDPOINT or --connect ENDPOINT"
        )
    keys.check(endpoints)
    signatures = keys.signatures(mission, robot)
    facts = FactsFile(options.facts, mission.number, robot) if options.facts else None
    if facts is not None:
        facts.read()  # a broken file is told before anything moves
    check_method(options.method, mission)
    make_body = body_maker(options.body)
    say(f"{options.robot}: making the first plan ...")
    plan = first_plan(mission, planner_of(options.method))
    ends = (options.listen, options.connect)
    transport = ZenohTransport(mission.number, robot, *ends, certificates=keys.certificates)
    try:
        body = make_body(mission, robot, transport)
        told = (keys.secret, facts, signatures, options.method)
        process = AgentProcess(mission, robot, plan, transport, body, *told, tells=True)
        say(f"agent {options.robot} of mission {mission.number:x}")
        return process.run()
    finally:
        transport.close()


def _number_of(mission: Mission, name: str) -> int:
    names = [robot.name for robot in mission.robots]
    if name not in names:
        shown = ", ".join(names[:12]) + (", ..." if len(names) > 12 else "")
        raise TeamformerError(f"there is no robot '{name}' in the mission", f"there are {shown}")
    return names.index(name)
