"""Every play of a tiny mission: all decisions of all teams, step after step."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np

from teamformer.mission.model import Mission
from teamformer.world.env import Decision, TeamFormation
from teamformer.world.rules.constants import NOBODY

MOST_TRIED = 600
"""Steps that are tried; with more of them nobody waits for the end."""


def fewest_steps(mission: Mission) -> int | None:
    """Return in how few steps a mission can be done; None where that was not found out."""
    states, tried = [TeamFormation([mission])], 0
    for step in range(1, mission.step_limit + 1):
        after: dict[bytes, TeamFormation] = {}
        for state in states:
            for wanted, named in _decisions(state, len(mission.tasks)):
                tried += 1
                if tried > MOST_TRIED:
                    return None
                twin = state.fork()
                twin.view()
                twin.step(Decision(wanted, named))
                if twin.tally().status == "completed":
                    return step
                if twin.is_running[0]:
                    after.setdefault(_key(twin), twin)
        states = list(after.values())
        if not states:
            return None
    return None


def _decisions(state: TeamFormation, tasks: int) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Return all that teams may want together: stay as they are, split or join, and any task."""
    view = state.view()
    counts = view.counts.copy()
    choices = []
    for row in range(len(counts)):
        members = slice(view.first_member[row], view.first_member[row + 1])
        own = view.member_counts[members].copy()
        wants = [counts[row]]
        for size in range(1, len(own)):
            for stay in itertools.combinations(range(len(own)), size):
                wants.append(own[list(stay)].sum(axis=0))
        for other in np.flatnonzero(view.can_join[row]):
            wants.append(counts[row] + view.seen_counts[row, other])
        named = (NOBODY, *range(tasks))
        choices.append([(want, task) for want in wants for task in named])
    for chosen in itertools.product(*choices):
        wanted = np.array([want for want, _ in chosen], np.int32).reshape(counts.shape)
        yield wanted, np.array([task for _, task in chosen], np.int32)


def _key(state: TeamFormation) -> bytes:
    """Return what of a world decides about its future."""
    worlds = state.worlds
    return b"".join(part.tobytes() for part in (worlds.robots, worlds.teams, worlds.tasks))
