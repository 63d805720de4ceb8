"""The central planner: knows everything, plans first, and then plays its plan."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np

from teamformer.base.errors import MissionError
from teamformer.files.drawn.smallest import smallest_mission
from teamformer.methods.central.plan_centrally import plan_centrally
from teamformer.methods.central.plays import CentralPlan
from teamformer.mission.checks.rules import rules_not_known_beforehand
from teamformer.mission.coordination import Plan
from teamformer.mission.model import Mission
from teamformer.planning.bounds.route_cover import raise_by_routes
from teamformer.planning.problem.relaxed_problem import relax
from teamformer.planning.relaxation.cp_sat import make_solver
from teamformer.planning.steps.arc_search import TeamArcs
from teamformer.planning.steps.situation import situation_in_hindsight
from teamformer.planning.steps.solve import first_plan
from teamformer.world.env import Decision
from teamformer.world.rules.constants import NOBODY
from teamformer.world.view import View

COMPILING = 600.0
"""Seconds to plan the smallest mission in: more than compiling takes, as it ends when proven."""


class Central:
    """Knows everything, searches for a plan for a time, proves bounds with OR-Tools CP-SAT.

    It plans for up to `time_limit` seconds a mission, then plays what it found. A search over who
    does what in which order counts what forming costs. Its best plan is played through the
    simulator beforehand, as are the relaxed schedule and simple rules; the fastest play becomes the
    script that `decide` reads out. A limit of 0 gives the first plan.
    `start` is a plan of all tasks that it plays and begins its search with, too.
    """

    needs_everything = True

    def __init__(
        self, time_limit: float = 10.0, workers: int = 2, start: Plan | None = None
    ) -> None:
        self.time_limit = time_limit
        self.workers = workers
        self.start = start
        self.plans: list[CentralPlan] = []

    def within(self, time_limit: float | None, workers: int | None) -> Central:
        """Return a planner that may take so long, with so many threads; None: as this one."""
        return Central(
            self.time_limit if time_limit is None else time_limit,
            self.workers if workers is None else workers,
            self.start,
        )

    def begin(self, everything: Sequence[Mission] | None, rng: np.random.Generator) -> None:
        """Plan every mission, for robots that know everything."""
        if everything is None:
            raise ValueError("the central planner has to be given the missions")
        self.plan(everything, everything, rng)

    def plan(
        self,
        everything: Sequence[Mission],
        believed: Sequence[Mission],
        rng: np.random.Generator,
    ) -> None:
        """Plan every source; MissionError names what no plan made beforehand can count with."""
        if problems := [it for mission in everything for it in rules_not_known_beforehand(mission)]:
            raise MissionError(problems)
        seed = int(rng.integers(2**31))
        _warm_up()
        self.plans = [
            plan_centrally(source, self.time_limit, seed, self.workers, own, self.start)
            for source, own in zip(everything, believed, strict=True)
        ]
        self._steps = np.zeros(len(self.plans), dtype=np.int64)

    def decide(self, view: View) -> Decision:
        """Read the next line of each world's script."""
        wanted = view.counts.copy()
        named = np.full(len(wanted), NOBODY, dtype=np.int32)
        for row, (w, slot) in enumerate(zip(view.world.tolist(), view.slot.tolist(), strict=True)):
            script = self.plans[w].script
            if self._steps[w] < len(script):
                counts, named[row] = script[self._steps[w]][slot]
                wanted[row, : len(counts)] = counts  # others in the batch may know more
        self._steps[np.unique(view.world)] += 1
        return Decision(wanted, named)


@cache
def _warm_up() -> None:
    """Have everything compiled and imported before the clock starts."""
    make_solver(seed=0)
    mission = smallest_mission()
    raise_by_routes(mission, relax(mission), 0, lambda _: None, lambda: False)
    situation = situation_in_hindsight(mission)
    plan = first_plan(situation)
    assert plan is not None, "the smallest mission can be done"
    TeamArcs(situation).improve(plan, rounds=1)
    plan_centrally(mission, time_limit=COMPILING)
