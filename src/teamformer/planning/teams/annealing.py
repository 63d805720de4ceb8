"""The search for a plan with forming counted: annealing (Kirkpatrick et al. 1983) over changes."""

from __future__ import annotations

import numpy as np

from teamformer.jit import entry, kernel, needs_compiling
from teamformer.model import Scenario
from teamformer.planning.relaxation.insertion import draw
from teamformer.planning.relaxation.problem import Relaxed
from teamformer.planning.teams.neighbourhood import change_plan, empty_bench, keep, undo
from teamformer.planning.teams.plan import (
    TeamPlan,
    copy_team_plan,
    empty_groups,
    empty_team_plan,
    overwrite_team_plan,
    time_plan,
)
from teamformer.rules.constants import NOBODY

COLD = 0.02
"""Temperature at the end of an annealing, in steps of makespan."""


class TeamSearch:
    """A search: where it stands, the best plan it has seen, and room to work in."""

    def __init__(self, problem: Relaxed, scenario: Scenario, start: TeamPlan, seed: int) -> None:
        self.problem = problem
        self._plan, self._best = empty_team_plan(problem), empty_team_plan(problem)
        self._groups = empty_groups(problem, scenario.starting_teams, scenario.forming_steps)
        self._bench = empty_bench(problem, seed)
        self._costs = np.full(2, np.inf)  # of the plan it stands at, of the best
        self.restart(start)

    def restart(self, start: TeamPlan) -> None:
        """Go on from another plan."""
        overwrite_team_plan(start, self._plan)
        cost, _ = time_plan(self.problem, self._plan, self._groups)
        self._costs[0] = cost
        if cost < self._costs[1]:
            overwrite_team_plan(start, self._best)
            self._costs[1] = cost

    def anneal(self, rounds: int, part: float, hot: float) -> None:
        """Search for some rounds at a part, from 0 to 1, of an annealing that begins so `hot`."""
        temperature = hot * (COLD / hot) ** part
        plans = (self._plan, self._best)
        anneal(self.problem, *plans, self._groups, self._bench, self._costs, rounds, temperature)

    @property
    def cost(self) -> float:
        """Return what the best plan costs; it falls whenever a better one is found."""
        return float(self._costs[1])

    @property
    def best(self) -> TeamPlan:
        """Return a copy of the best plan."""
        return TeamPlan(*(array.copy() for array in self._best))

    @property
    def makespan(self) -> int:
        """Return the step in which the best plan is done."""
        return int(time_plan(self.problem, self._best, self._groups)[1])


def is_compiled() -> bool:
    """Say whether the search was compiled before, so that a first plan has not to wait for it."""
    return not needs_compiling(anneal)


@entry
def anneal(problem, plan, best, groups, bench, costs, rounds, temperature):  # type: ignore[no-untyped-def]
    """Make changes for a number of rounds; keep those that are better or, at times, a bit worse.

    `plan` is where the search stands and `best` the best seen; `costs` holds the costs of both.
    """
    time_plan(problem, plan, groups)
    _trace(plan, groups, bench)
    for _ in range(rounds):
        if not change_plan(problem, plan, bench):
            undo(plan, bench)
            continue
        cost, _ = time_plan(problem, plan, groups)
        allowed = costs[0] - temperature * np.log(1.0 - draw(bench.random))
        if cost > allowed:
            undo(plan, bench)
            continue
        keep(bench)
        costs[0] = cost
        _trace(plan, groups, bench)
        if cost < costs[1]:
            costs[1] = cost
            copy_team_plan(plan, best)


@kernel
def _trace(plan, groups, bench):  # type: ignore[no-untyped-def]
    """List the tasks that the makespan hangs on, from the last backwards."""
    task = 0
    for other in range(len(plan.order)):
        if groups.end[other] > groups.end[task]:
            task = other
    length = 0
    while task != NOBODY:
        bench.critical[length] = task
        length += 1
        task = groups.before[task]
    bench.length[0] = length
