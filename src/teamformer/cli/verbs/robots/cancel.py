"""`teamformer fleet cancel`: a task of a running fleet is called off."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING

from teamformer.base.errors import TeamformerError
from teamformer.cli.verbs.robots.mesh import (
    FleetAt,
    dial_as_operator,
    have_accepted,
    read_fleet_mission,
)

if TYPE_CHECKING:
    from teamformer.fleet.fleet_mission import FleetMission
    from teamformer.fleet.messages import TaskFact

LISTENS = 3.0
"""Seconds that agents have to tell which tasks operators have added."""


def cancel(path: Path, name: str, fleet: FleetAt) -> int:
    """Call a task of a running fleet off; return 0 once enough robots hold that."""
    mission = read_fleet_mission(path, "zenoh")
    from teamformer.fleet.operator import Operator

    operator = Operator(_find(name, mission, fleet), mission.robots, calls_off=True)
    return have_accepted(operator, mission, fleet)


def _find(name: str, mission: FleetMission, fleet: FleetAt) -> TaskFact:
    """Return the mission's task, or the one that an operator added, of a name."""
    own = next((task for task in mission.tasks if task.name == name), None)
    added = {} if own is not None else _added(mission, fleet)
    found = own or added.get(name)
    if found is None:
        known = ", ".join([*(task.name for task in mission.tasks), *added])
        raise TeamformerError(f"there is no task '{name}'", f"there are {known}")
    return found


def _added(mission: FleetMission, fleet: FleetAt) -> dict[str, TaskFact]:
    """Return the tasks that operators have added, by name, as the first robot tells that answers.

    Who offers a task that all know is told all facts.
    """
    from teamformer.fleet.messages import EVERYBODY, OPERATOR, FactsNote, Notice, Offer
    from teamformer.fleet.operator import AGAIN

    transport, post = dial_as_operator(mission, fleet)
    deadline = time.monotonic() + LISTENS
    try:
        while time.monotonic() < deadline:
            transport.send(
                EVERYBODY, post.seal(OPERATOR, Notice(EVERYBODY, Offer(mission.tasks[0])))
            )
            for data in transport.receive(AGAIN):
                message, _ = post.judge(data)
                if message is not None and type(message.body) is FactsNote:
                    return {task.name: task for task in message.body.added}
    finally:
        transport.close()
    return {}
