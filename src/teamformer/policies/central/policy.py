"""The central planner: knows everything, plans first, and then plays its plan."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np

from teamformer.model import Scenario
from teamformer.planning.bounds.route_cover import raise_by_routes
from teamformer.planning.coalitions.rules import warm_up as warm_up_coalitions
from teamformer.planning.relaxation.cp_sat import make_solver
from teamformer.planning.relaxation.problem import relax
from teamformer.planning.teams.facts import situation_in_hindsight
from teamformer.planning.teams.solve import first_search
from teamformer.policies.central.planner import plan_centrally
from teamformer.policies.central.plays import CentralPlan
from teamformer.rules.constants import NOBODY
from teamformer.scenarios.smallest import smallest_scenario
from teamformer.sim.env import Decision
from teamformer.sim.view import View

COMPILING = 600.0
"""Seconds to plan the smallest scenario in: more than compiling takes, as it ends when proven."""


class Central:
    """Plans for up to `time_limit` seconds a scenario, then plays what it found.

    A search over who does what in which order counts what forming costs. Its best plan is
    played through the simulator beforehand, as are the relaxed schedule, simple rules and the
    default policy; the fastest play becomes the script that `decide` reads out. A limit of 0 gives
    the first plan.
    """

    needs_everything = True

    def __init__(self, time_limit: float = 10.0, workers: int = 2) -> None:
        self.time_limit = time_limit
        self.workers = workers
        self.plans: list[CentralPlan] = []

    def begin(self, everything: Sequence[Scenario] | None, rng: np.random.Generator) -> None:
        """Plan every scenario."""
        if everything is None:
            raise ValueError("the central planner has to be given the scenarios")
        self.begin_in(everything, everything, rng)

    def begin_in(
        self, truths: Sequence[Scenario], seen: Sequence[Scenario], rng: np.random.Generator
    ) -> Sequence[Scenario]:
        """Plan every scenario; return those in which the best plan is to be played."""
        seed = int(rng.integers(2**31))
        for allocation in sorted({scenario.allocation for scenario in truths}):
            _warm_up(allocation)
        if any(task.after for scenario in truths for task in scenario.tasks):
            warm_up_coalitions()
        both = list(zip(truths, seen, strict=True))
        self.plans = [
            plan_centrally(truth, self.time_limit, seed, self.workers, believed)
            for truth, believed in both
        ]
        self._steps = np.zeros(len(self.plans), dtype=np.int64)
        return [
            believed if plan.is_as_seen else truth
            for plan, (truth, believed) in zip(self.plans, both, strict=True)
        ]

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
def _warm_up(allocation: str) -> None:
    """Have everything compiled and imported before the clock starts."""
    make_solver(seed=0)
    scenario = replace(smallest_scenario(), allocation=allocation)
    raise_by_routes(scenario, relax(scenario), 0, lambda _: None, lambda: False)
    search = first_search(situation_in_hindsight(scenario), seed=0)
    assert search is not None, "the smallest scenario can be done"
    search.run(1, 0.0)
    plan_centrally(scenario, time_limit=COMPILING)
