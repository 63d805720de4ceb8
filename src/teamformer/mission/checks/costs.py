"""What a plan costs: a mean, by the weights of the mission, of when things end and how late."""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from teamformer.base.errors import Problem
from teamformer.mission.keys.mission_keys import COST_KEYS
from teamformer.mission.keys.task_keys import LARGEST_WEIGHT, SMALLEST_WEIGHT

if TYPE_CHECKING:
    from teamformer.mission.model import Mission, Task

COST_PARTS = tuple(key.name for key in COST_KEYS)
"""What a cost may weigh; times are added up by the weights of the tasks."""

ONLY_IN_CONTINUOUS_TIME = "travel"

LATENESS = 2
"""What tardiness weighs beside the makespan in a mission with windows and without a cost."""


def cost_of(weights: Mapping[str, float], parts: Mapping[str, float]) -> float:
    """Return the mean of a plan's parts, by weight."""
    weighed = sum(weight * parts[name] for name, weight in weights.items())
    return weighed / sum(weights.values())


def judged_by(mission: Mission) -> Mapping[str, float] | None:
    """Return the weights that plans of a mission are judged by; None: the makespan alone.

    A mission with windows and without a cost has its makespan and how late tasks are.
    """
    if mission.cost is None and any(task.between for task in mission.tasks):
        return {"makespan": 1, "tardiness": LATENESS}
    return mission.cost


def parts_of_ends(
    tasks: Sequence[Task], ends: Mapping[int, float], called_off: Container[int] = ()
) -> dict[str, float]:
    """Return what a cost weighs of when tasks end; `ends` has the end of each, by number.

    Optional tasks without one are missed, unless they are called off.
    """
    late = {
        number: max(0.0, end - between[1])
        for number, end in ends.items()
        if (between := tasks[number].between) is not None
    }
    return {
        "tardiness": sum(tasks[number].weight * by for number, by in late.items()),
        "max_tardiness": max(late.values(), default=0.0),
        "completion": sum(tasks[number].weight * end for number, end in ends.items()),
        "missed": sum(
            task.weight
            for number, task in enumerate(tasks)
            if task.optional and number not in ends and number not in called_off
        ),
    }


def cost_in_steps(
    mission: Mission,
    ends: Mapping[int, float],
    makespan: float | None,
    called_off: Container[int] = (),
) -> float | None:
    """Return what a mission in steps costs that is over, None if it is not or has no cost.

    `ends` are the steps in which tasks were done, by number; those called off cost nothing. The
    `makespan` is None as long as it is not over.
    """
    if mission.cost is None or makespan is None:
        return None
    return weighed(mission, mission.cost, ends, makespan, called_off)


def weighed(
    mission: Mission,
    weights: Mapping[str, float],
    ends: Mapping[int, float],
    makespan: float,
    called_off: Container[int] = (),
) -> float:
    """Return the mean, by weights, of when all is over, when tasks end and how late, in steps.

    Optional tasks without an end are missed, unless they are called off.
    """
    parts = parts_of_ends(mission.tasks, ends, called_off)
    return cost_of(weights, {"makespan": makespan, **parts})


def find_cost_problems(mission: Mission) -> Iterator[Problem]:
    """Return what is wrong with the weights of the cost and of tasks."""
    for number, task in enumerate(mission.tasks):
        if not SMALLEST_WEIGHT <= task.weight <= LARGEST_WEIGHT:
            message = f"the weight of task '{task.name}' is {task.weight:g}"
            remedy = f"use {SMALLEST_WEIGHT:g} to {LARGEST_WEIGHT:g}"
            yield Problem(("tasks", number, "weight"), f"{message}; {remedy}")
    if mission.cost is None:
        return
    if not mission.cost:
        yield Problem(("cost",), f"the cost has no weights; name {', '.join(COST_PARTS)}, or some")
    for name, weight in mission.cost.items():
        if name not in COST_PARTS:
            choices = ", ".join(COST_PARTS)
            yield Problem(("cost", name), f"a cost has no '{name}'; use {choices}")
        elif not SMALLEST_WEIGHT <= weight <= LARGEST_WEIGHT:
            message = f"the weight of {name} is {weight:g}; use {SMALLEST_WEIGHT:g} to"
            yield Problem(("cost", name), f"{message} {LARGEST_WEIGHT:g}")
