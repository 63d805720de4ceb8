"""Scripted policies that are stronger than the paper's heuristic: the honest bar for learning."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from teamformer.jit import allocating_kernel, entry, kernel
from teamformer.model import Scenario
from teamformer.policies.scripted.pairing import is_partner, pair_by_slot
from teamformer.rules.arrays import Array
from teamformer.rules.constants import NOBODY
from teamformer.sim.env import Decision
from teamformer.sim.view import View

CROWD = 8
"""A task that needs more capabilities draws a crowd, in which pairing off takes long."""


class JoinAll:
    """Join a team in the same place whenever it adds what an open task needs; never split.

    Useful means: some task in view needs more of a capability than the own team has, and the
    other team has it. Teams in one place pair off by slot, first with second, third with fourth,
    so that many become one in few steps.
    """

    needs_everything = False
    only_mates = False

    def begin(self, everything: Sequence[Scenario] | None, rng: np.random.Generator) -> None:
        """Nothing to prepare."""

    def decide(self, view: View) -> Decision:
        """Join whom it helps to join."""
        wanted = view.counts.copy()
        _decide(view, wanted, self.only_mates)
        return Decision(wanted)


class JoinAtTask(JoinAll):
    """Do as `JoinAll`, but at the own task only, with others of the crew that it is given to too.

    So robots of a crew that have different tasks next do them side by side, and who waits at a
    task pairs off meanwhile: step for step as the crew's list was planned.
    """

    only_mates = True


class JoinCrew(JoinAtTask):
    """Do as `JoinAtTask`; before large tasks join on the way whom one would have to wait for.

    These are teams with another task next, where the later of the two tasks needs both teams.
    """

    def decide(self, view: View) -> Decision:
        """Join whom it helps to join, or else whom one would have to wait for."""
        wanted = super().decide(view).wanted
        _join_on_the_way(view, wanted)
        return Decision(wanted)


class JoinUseful:
    """Do as `JoinCrew` where tasks are shared out among crews, elsewhere as `JoinAll`."""

    needs_everything = False

    def begin(self, everything: Sequence[Scenario] | None, rng: np.random.Generator) -> None:
        """Nothing to prepare."""

    def decide(self, view: View) -> Decision:
        """Join whom it helps to join."""
        wanted = JoinAll().decide(view).wanted
        if view.has_crews.any():
            of_crew = JoinCrew().decide(view).wanted
            wanted[view.has_crews] = of_crew[view.has_crews]
        return Decision(wanted)


@entry
def _decide(view: View, wanted: Array, only_mates: bool) -> None:
    lacks = np.empty(view.counts.shape[1], dtype=np.bool_)
    for row in range(len(wanted)):
        if view.is_serving[row] or (only_mates and not view.is_at_task[row]):
            continue
        _mark_lacks(view, row, lacks)
        chosen = pair_by_slot(view, row, only_mates, only_mates)
        if chosen == NOBODY or not _is_useful(view, row, chosen, lacks):
            chosen = _first_useful(view, row, lacks, only_mates)
        if chosen != NOBODY:
            for cap in range(len(lacks)):
                wanted[row, cap] += view.seen_counts[row, chosen, cap]


@allocating_kernel
def _mark_lacks(view: View, row: int, lacks: Array) -> None:
    """Mark the capabilities of which a task in view needs more than the team has."""
    lacks[:] = False
    for task in range(view.task_number.shape[1]):
        for cap in range(len(lacks)):
            lacks[cap] |= view.task_needs[row, task, cap] > view.counts[row, cap]


@kernel
def _first_useful(view: View, row: int, lacks: Array, only_mates: bool) -> int:
    for other in range(view.seen_slot.shape[1]):
        is_possible = is_partner(view, row, other, only_mates, only_mates)
        if is_possible and _is_useful(view, row, other, lacks):
            return other
    return NOBODY


@kernel
def _is_useful(view: View, row: int, other: int, lacks: Array) -> bool:
    for cap in range(len(lacks)):
        if lacks[cap] and view.seen_counts[row, other, cap] > 0:
            return True
    return False


@entry
def _join_on_the_way(view: View, wanted: Array) -> None:
    """Let teams that join nobody else join the first of their crew here that shares a task."""
    for row in range(len(wanted)):
        is_free = not view.is_serving[row] and (wanted[row] == view.counts[row]).all()
        if not is_free or (view.task_needs[row, 0] > 0).sum() <= CROWD:
            continue
        for other in range(view.seen_slot.shape[1]):
            if is_partner(view, row, other, False, True) and _share_a_task(view, row, other):
                wanted[row] += view.seen_counts[row, other]
                break


@kernel
def _share_a_task(view: View, row: int, other: int) -> bool:
    """Say whether the task of one of two teams needs something of the other one too.

    The earlier of two tasks of a crew needs nothing of a team that has the later one next. So if
    the later one needs something of both, it waits for the team with the earlier one: nobody is
    later because they go on together.
    """
    own, theirs = view.task[row], view.seen_task[row, other]
    for task in range(view.task_number.shape[1]):
        number = view.task_number[row, task]
        for cap in range(view.task_needs.shape[2]):
            if number != NOBODY and view.task_needs[row, task, cap] > 0:
                if number == own and view.seen_counts[row, other, cap] > 0:
                    return True
                if number == theirs and view.counts[row, cap] > 0:
                    return True
    return False
