"""The coalition problem: tasks at places, robots on their ways between them, in whole numbers.

A task starts when its release has come, all tasks before it have ended and the last robot of its
coalition is there (and, where its robots do not come together, it has formed); it stays until the
task ends. Robots go straight on, and home at the end. A load goes as fast as the slowest of those
who carry it: its task takes longer with some robots than with others.
Times are ticks, whole numbers, so that a plan is the same on every processor.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from teamformer.base.array_types import Int32s, Ints
from teamformer.planning.problem.batteries import Batteries, no_batteries
from teamformer.planning.problem.constants import NEVER
from teamformer.planning.problem.docks import Docks, no_docks
from teamformer.planning.problem.links import Links, no_links
from teamformer.planning.problem.misses import Misses, no_misses
from teamformer.planning.problem.rotas import Rotas, no_rotas, of_kinds
from teamformer.world.rules.constants import NOBODY

__all__ = [
    "NEVER",
    "NOBODY",
    "SPARES",
    "CoalitionProblem",
    "different_rows",
    "pose_problem",
]

SPARES = 4
"""How many robots more than it needs come to a task at most, where that may pay."""


class CoalitionProblem(NamedTuple):
    """The problem as plain arrays; places are the tasks, then the robots' starts."""

    ways: Ints  # (paces, places, tasks) ticks from a place to a task
    home: Ints  # (kinds, places) ticks from a place home; 0 where robots may stay
    site: Int32s  # (places,) the same number for places that lie at the same position
    pace: Int32s  # (robots,) row of `ways`
    kind: Int32s  # (robots,) row of `home`; robots of a kind differ in nothing but their start
    like: Int32s  # (kinds, robots) the robots of each kind, then NOBODY
    origin: Int32s  # (robots,) the place where each starts
    counts: Int32s  # (robots, caps)
    needs: Int32s  # (tasks, caps)
    able: Int32s  # (caps, robots) the robots with each capability, then NOBODY
    duration: Ints  # (tasks,) of the fastest coalition that there can be
    slower: Ints  # (paces, tasks) how much longer a load takes where somebody of a pace carries it
    release: Ints  # (tasks,) no task starts before
    due: Ints  # (tasks,) tasks that end later are late; NEVER
    before: Int32s  # (tasks, most) the tasks that must have ended before each, then NOBODY
    after: Int32s  # (tasks, most) the tasks that each must have ended before, then NOBODY
    forming: Ints  # (1,) what a coalition takes whose robots do not all come from one site
    spares: int  # how many robots more than it needs come to a task at most
    ready: Ints  # (places - tasks,) when who is at each place that is no task can leave it
    links: Links  # of starts, and what plans cost; empty where the makespan alone counts
    misses: Misses  # what is missed if the mission is over before a task is done
    rotas: Rotas  # when the robots of each kind work; empty where all always do
    batteries: Batteries  # of no kinds where nobody has one
    docks: Docks  # zones of loads; no search counts with them
    bodies: int  # how many robots there are; those behind them are permits of zones


def pose_problem(
    ways: npt.ArrayLike,
    home: npt.ArrayLike,
    pace: npt.ArrayLike,
    origin: npt.ArrayLike,
    counts: npt.ArrayLike,
    needs: npt.ArrayLike,
    duration: npt.ArrayLike,
    slower: npt.ArrayLike | None = None,
    release: npt.ArrayLike | None = None,
    due: npt.ArrayLike | None = None,
    precedence: Sequence[tuple[int, int]] = (),
    forming: int = 0,
    site: npt.ArrayLike | None = None,
    apart: npt.ArrayLike | None = None,
    spares: int = 0,
    ready: npt.ArrayLike | None = None,
    links: Links | None = None,
    misses: Misses | None = None,
    rotas: Rotas | None = None,
    permits: int = 0,
) -> CoalitionProblem:
    """Return a problem with its lists worked out; `home` is (robots, places) here.

    `precedence` holds pairs of tasks, the earlier one first; they must not go in a circle. Without
    `site` no two places lie at the same position; without `slower` all carry loads equally fast.
    Robots with different numbers in `apart` (robots,) are of different kinds; `rotas` has the
    shifts of each robot. Without `ready` all robots can leave at once. The last `permits` of the
    robots have no body: coalitions need them, and nobody forms with them.
    """
    ways, home = np.asarray(ways, np.int64), np.asarray(home, np.int64)
    counts, needs = np.asarray(counts, np.int32), np.asarray(needs, np.int32)
    pace, tasks = np.asarray(pace, np.int32), len(needs)
    slower = np.zeros((len(ways), tasks)) if slower is None else slower
    slower = np.ascontiguousarray(slower, np.int64)
    apart = np.asarray(np.zeros(len(counts)) if apart is None else apart, np.int64)
    traits = np.column_stack([counts, pace, home, apart])  # (robots, traits)
    first, kind = different_rows(traits)
    return CoalitionProblem(
        ways=np.ascontiguousarray(ways),
        home=np.ascontiguousarray(home[first]),
        site=np.arange(ways.shape[1], dtype=np.int32)
        if site is None
        else np.asarray(site, np.int32),
        pace=pace,
        kind=kind,
        like=listed([np.flatnonzero(kind == which) for which in range(len(first))]),
        origin=np.asarray(origin, np.int32),
        counts=counts,
        needs=needs,
        able=listed([np.flatnonzero(column) for column in counts.T]),
        duration=np.asarray(duration, np.int64),
        slower=slower,
        release=np.zeros(tasks, np.int64) if release is None else np.asarray(release, np.int64),
        due=np.full(tasks, NEVER) if due is None else np.asarray(due, np.int64),
        before=listed([[i for i, j in precedence if j == task] for task in range(tasks)]),
        after=listed([[j for i, j in precedence if i == task] for task in range(tasks)]),
        forming=np.array([forming]),
        spares=spares,
        ready=np.asarray(np.zeros(ways.shape[1] - tasks) if ready is None else ready, np.int64),
        links=no_links() if links is None else links,
        misses=no_misses() if misses is None else misses,
        rotas=no_rotas() if rotas is None else of_kinds(rotas, first),
        batteries=no_batteries(),
        docks=no_docks(),
        bodies=len(counts) - permits,
    )


def different_rows(rows: npt.NDArray[np.generic]) -> tuple[npt.NDArray[np.intp], Int32s]:
    """Return where each different row is seen first, and which of these every row is.

    They are numbered in the order in which they are seen, whatever the order of the columns: that
    of a mission's capabilities means nothing.
    """
    _, first, number = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    return np.sort(first), np.argsort(np.argsort(first))[number.ravel()].astype(np.int32)


def listed(rows: Sequence[Sequence[int] | Ints]) -> Int32s:
    """Return lists of different lengths as one array, with NOBODY after each."""
    table = np.full((len(rows), 1 + max(map(len, rows), default=0)), NOBODY, np.int32)
    for row, numbers in zip(table, rows, strict=True):
        row[: len(numbers)] = numbers
    return table
