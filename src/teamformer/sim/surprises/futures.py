"""Futures: what nobody has seen yet, drawn anew as likely as what is known lets it be.

Nothing here looks at the truth: two worlds in which the same is known get the same futures.
"""

from __future__ import annotations

import numpy as np

from teamformer.model import Scenario
from teamformer.sim.arrays import Worlds


def hides_no_more(scenario: Scenario) -> bool:
    """Say whether nothing is uncertain but what tasks need and where they are."""
    is_sure = scenario.arrivals is None and all(task.lasts is None for task in scenario.tasks)
    return is_sure and not any(robot.has_surprises for robot in scenario.robots)


def draw_hidden(worlds: Worlds, w: int, rng: np.random.Generator) -> None:
    """Draw the needs and the places that nobody knows in a world, and make them its truth.

    A capability that a task may need is needed with its probability, independently; a task is in
    any of the places left with the same probability.
    """
    tasks = worlds.tasks[w]
    for task in np.flatnonzero(tasks["hides_needs"]):
        is_needed = rng.random(worlds.may_need.shape[2]) < worlds.may_need[w, task]
        needs = np.where(is_needed, worlds.worst_needs[w, task], worlds.sure_needs[w, task])
        worlds.true_needs[w, task] = needs
    for task in np.flatnonzero(tasks["hides_place"]):
        tasks["lies_in"][task] = rng.choice(np.flatnonzero(worlds.spots["is_possible"][w, task]))
