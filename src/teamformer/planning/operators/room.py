"""Room that operators share: to choose coalitions in, and to note what they have moved."""

from __future__ import annotations

from typing import NamedTuple

from teamformer.planning.graph.arc_problem import ArcProblem
from teamformer.planning.operators.candidates import CandidateRoom, empty_candidates
from teamformer.planning.operators.coalition_choice import Choice, empty_choice
from teamformer.planning.operators.moved import Moved, empty_moved


class Room(NamedTuple):
    """Room to work in; an operator takes what it needs of it."""

    choice: Choice
    candidates: CandidateRoom
    moved: Moved


def empty_room(problem: ArcProblem, seats: int) -> Room:
    """Return room for a graph with so many seats."""
    most = int(problem.most[0])
    return Room(empty_choice(problem, most), empty_candidates(problem, seats), empty_moved(most))
