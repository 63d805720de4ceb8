"""What happens to a mission as trees of JSON: as pages tell of incidents, and with plans."""

from __future__ import annotations

from typing import Any

from teamformer.files.trees.writer import task_to_tree
from teamformer.live.running.forecasts import Forecast, Unfinished
from teamformer.live.running.incidents import (
    CancelledTask,
    Happening,
    LostRobot,
    NewTask,
    NewWeight,
    PlanTakenOver,
)
from teamformer.live.running.messages import read_incident
from teamformer.live.running.page_trees import Tree
from teamformer.mission.coordination import Plan
from teamformer.mission.model import Mission


def happening_to_tree(happening: Happening, mission: Mission) -> Tree:
    """Return what happens as the message of a page has it, with the plan that it brings."""
    match happening:
        case NewTask():
            return {"task": task_to_tree(happening.task, mission.world)}
        case LostRobot():
            return {"lost": happening.robot}
        case CancelledTask():
            return {"cancelled": happening.task}
        case NewWeight():
            weight = {"weighs": happening.task, "weight": happening.weight}
            return weight | {"plan": None if happening.plan is None else vars(happening.plan)}
        case PlanTakenOver():
            ends = {key: _forecast_to_tree(getattr(happening, key)) for key in ENDS}
            return {"plan": vars(happening.plan)} | ends
        case _:
            return {"back": happening.robot}


def happening_from_tree(tree: Tree, mission: Mission) -> Happening:
    """Return what happened to a mission; TeamformerError says why it cannot."""
    plan = None if tree.get("plan") is None else plan_from_tree(tree["plan"])
    if plan is not None and "weighs" not in tree:
        return PlanTakenOver(plan, *(_forecast_from_tree(tree[key]) for key in ENDS))
    incident = read_incident(tree, mission)
    if isinstance(incident, NewWeight):
        return NewWeight(incident.task, incident.weight, plan)
    return incident


def plan_from_tree(tree: Tree) -> Plan:
    """Return a plan of its fields by name."""
    return Plan(**{key: _tuples(value) for key, value in tree.items()})


ENDS = ("forecast", "without")
"""How a mission ends by a plan that is taken over, and how it was to end before."""


def _forecast_to_tree(found: Forecast) -> Tree:
    """Return what is told of a forecast in words."""
    other = found.otherwise
    told = {"futures": found.futures, "ends": found.ends}
    ended = None if other is None else {"status": other.status, "steps": other.end}
    return told | {"otherwise": ended}


def _forecast_from_tree(tree: Tree) -> Forecast:
    other = tree["otherwise"]
    ended = None if other is None else Unfinished(other["status"], other["steps"])
    return Forecast(tree["futures"], tuple(tree["ends"]), ended)


def _tuples(value: Any) -> Any:
    """Turn lists, nested ones too, into tuples."""
    return tuple(_tuples(part) for part in value) if isinstance(value, list) else value
