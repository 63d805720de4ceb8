"""An agent of a fleet on this machine: `python -m ... FOLDER ROBOT`, as `LocalFleet` starts it.

The folder holds all that it has to know, plan 0 included, so that the robots need not each work
that out; and what it must not forget.
"""

from __future__ import annotations

import sys
from pathlib import Path

from msgspec import Struct
from msgspec.msgpack import decode, encode

from teamformer.base.errors import TeamformerError
from teamformer.files.mission_files import read_mission, write_mission
from teamformer.fleet.agent.planning import FleetPlan
from teamformer.fleet.bodies.remote import RemoteBody
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.messages import PlanNote
from teamformer.fleet.process.facts_file import FactsFile
from teamformer.fleet.process.loop import AgentProcess
from teamformer.fleet.transports.keys import read_keys
from teamformer.fleet.transports.zenoh_mesh import ZenohTransport
from teamformer.mission.model import Mission

MODULE = "teamformer.fleet.process.local_agent"
MISSION, START = "mission.json", "start"


class Start(Struct, array_like=True):
    """What every agent is told: `endpoints` are those of the robots, and the world's at last."""

    plan: PlanNote
    endpoints: tuple[str, ...]
    method: str
    drop: float
    keys: str | None


def write_start(folder: Path, mission: Mission, start: Start) -> None:
    """Write what agents are told into a folder."""
    write_mission(mission, folder / MISSION)
    (folder / START).write_bytes(encode(start))


def run_agent(folder: Path, robot: int) -> int:
    """Run the mind of a robot until it is told to end; return the exit status.

    It dials the world and all agents before it.
    """
    source = read_mission(folder / MISSION)
    mission = FleetMission(source, source.seconds_a_step)
    start = decode((folder / START).read_bytes(), type=Start)
    keys = read_keys(None if start.keys is None else Path(start.keys))
    signatures = keys.signatures(mission, robot)
    facts = FactsFile(folder / f"facts-{robot}", mission.number, robot)
    others = (start.endpoints[-1], *start.endpoints[:robot])
    transport = ZenohTransport(mission.number, robot, start.endpoints[robot], others, start.drop)
    try:
        body = RemoteBody(transport, robot)
        told = (keys.secret, facts, signatures, start.method)
        plan = FleetPlan(start.plan)
        return AgentProcess(mission, robot, plan, transport, body, *told).run()
    finally:
        transport.close()


def main() -> int:
    """Run the agent that the command line names; say what a user has done wrong."""
    folder, robot = sys.argv[1:]
    try:
        return run_agent(Path(folder), int(robot))
    except TeamformerError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
