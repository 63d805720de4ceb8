"""Where a search stands: its graph, the change at hand and what it costs, and room to work in."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from teamformer.base.array_types import Array, Ints
from teamformer.planning.graph.arc_problem import ArcProblem, StepRules
from teamformer.planning.graph.changes import ArcChange
from teamformer.planning.graph.graph import Graph, empty_graph
from teamformer.planning.graph.ledger import Ledger, empty_ledger, room_for_change
from teamformer.planning.operators.candidates import CandidateRoom, empty_candidates
from teamformer.planning.operators.coalition_choice import Choice, empty_choice
from teamformer.planning.operators.stretches import LONGEST
from teamformer.planning.problem.coalition_problem import CoalitionProblem


class SearchState(NamedTuple):
    """What a search changes; an operator takes what it needs of it."""

    graph: Graph
    trial: ArcChange
    ledger: Ledger
    choice: Choice
    candidates: CandidateRoom
    stretch: Ints  # (LONGEST,) room for the tasks that a stretch has
    random: Array  # (1,) state of the random numbers


def empty_state(
    problem: CoalitionProblem, arcs: ArcProblem, steps: StepRules | None, seed: int
) -> SearchState:
    """Return the state of a search at an empty graph, with its random numbers seeded."""
    graph, most = empty_graph(problem, steps), int(arcs.most[0])
    return SearchState(
        graph,
        room_for_change(arcs, graph),
        empty_ledger(arcs),
        empty_choice(arcs, most),
        empty_candidates(arcs, len(graph.seats)),
        np.zeros(LONGEST, np.int64),
        np.array([(seed * 2654435761 + 88172645463325252) % 2**64], np.uint64),
    )
