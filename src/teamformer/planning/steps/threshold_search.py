"""The search for a shared plan: threshold accepting (Dueck and Scheuer 1990), in whole numbers."""

from __future__ import annotations

import numpy as np

from teamformer.jit import entry, kernel
from teamformer.planning.prices import SHARES
from teamformer.planning.relaxation.problem import Relaxed, has_prices
from teamformer.planning.relaxation.relaxed_plan import Array
from teamformer.planning.steps.crossings import Crossings
from teamformer.planning.steps.neighbourhood import (
    Workspace,
    change_plan,
    empty_workspace,
    keep,
    undo,
)
from teamformer.planning.steps.passing import settle
from teamformer.planning.steps.team_plan import (
    TeamPlan,
    copy_team_plan,
    empty_team_plan,
    overwrite_team_plan,
)
from teamformer.planning.steps.timing import (
    ENDLESS,
    STEP,
    Groups,
    empty_groups,
    is_settled,
    time_plan,
)
from teamformer.rules.constants import NOBODY

COOLER = 5
"""Searches by prices are so much cooler: what is late in a plan is a small part of its cost."""


class ThresholdSearch:
    """A search: where it stands, the best plan it has seen, and room to work in."""

    def __init__(
        self,
        problem: Relaxed,
        crossings: Crossings,
        company: Array,
        forming_steps: int,
        seed: int = 0,
    ) -> None:
        self.problem, self.crossings = problem, crossings
        self._plan, self._best, self._spare = (empty_team_plan(problem) for _ in range(3))
        self._groups = empty_groups(problem, company, forming_steps)
        self._workspace = empty_workspace(problem, seed)
        self._costs = np.full(2, ENDLESS, np.int64)

    def begin(self, start: TeamPlan) -> int:
        """Go on from a plan; return its cost once it is settled."""
        overwrite_team_plan(start, self._plan)
        self._costs[0] = ENDLESS
        self._search(self._plan, 0)
        return int(self._costs[0])

    def run(self, rounds: int, hot: float, cool: float = 0.0) -> None:
        """Search for some rounds; plans may be worse by `hot` steps at first, `cool` in the end."""
        step = (SHARES // COOLER if has_prices(self.problem) else STEP) * len(self.problem.appears)
        self._search(self._plan, rounds, int(hot * step), int(cool * step))

    def _search(self, plan: TeamPlan, rounds: int, hot: int = 0, cool: int = 0) -> None:
        room = (self._spare, self._groups, self._workspace, self._costs)
        search(self.problem, self.crossings, plan, self._best, *room, rounds, hot, cool)

    @property
    def cost(self) -> int:
        """Return what the best plan costs."""
        return int(self._costs[1])

    @property
    def best(self) -> TeamPlan:
        """Return a copy of the best plan."""
        return TeamPlan(*(array.copy() for array in self._best))

    @property
    def ends(self) -> Array:
        """Return the steps in which tasks are done in the best plan, (tasks,)."""
        self._search(self._best, 0)
        return self._groups.end[: len(self.problem.appears)].copy()

    @property
    def makespan(self) -> int:
        """Return the step in which the best plan is done."""
        return int(self.ends.max())


@entry
def search(
    problem: Relaxed,
    crossings: Crossings,
    plan: TeamPlan,
    best: TeamPlan,
    spare: TeamPlan,
    groups: Groups,
    workspace: Workspace,
    costs: Array,
    rounds: int,
    hot: int,
    cool: int,
) -> None:
    """Make changes for a number of rounds; keep those that cost at most so much more.

    `plan` is where the search stands and `best` the best seen; `costs` holds the costs of both,
    ENDLESS for a plan that was never timed: it is settled first. `spare` is room to work in; `hot`
    is what a change may cost at first and `cool` in the end. Without any round `plan` is timed and
    stays as it is.
    """
    if costs[0] == ENDLESS:
        cost, _, _ = settle(problem, crossings, plan, groups, workspace, np.int64(ENDLESS))
        costs[0] = cost
        if cost < costs[1]:
            costs[1] = cost
            copy_team_plan(plan, best)
    time_plan(problem, crossings, plan, groups, np.int64(ENDLESS))
    _trace(problem, plan, groups, workspace)
    for made in range(rounds):
        allowed = costs[0] + (hot * (rounds - made) + cool * made) // rounds
        if not change_plan(problem, plan, workspace):
            undo(plan, workspace)
            continue
        cost, _ = time_plan(problem, crossings, plan, groups, allowed)
        if cost > allowed:
            undo(plan, workspace)
            continue
        if not is_settled(groups):
            copy_team_plan(plan, spare)
            cost, _, is_good = settle(problem, crossings, plan, groups, workspace, allowed)
            if cost > allowed or not is_good:
                copy_team_plan(spare, plan)
                undo(plan, workspace)
                continue
        keep(workspace)
        costs[0] = cost
        _trace(problem, plan, groups, workspace)
        if cost < costs[1]:
            costs[1] = cost
            copy_team_plan(plan, best)


@kernel
def _trace(problem: Relaxed, plan: TeamPlan, groups: Groups, workspace: Workspace) -> None:
    """List the tasks that the last task hangs on or, if some are late, the dearest late one."""
    task, dearest = 0, np.int64(0)
    for other in range(len(plan.order)):
        if groups.end[other] > groups.end[task]:
            task = other
    for other in range(len(problem.prices.due)):
        late = groups.end[other] - problem.prices.due[other]
        if late > 0 and late * problem.prices.late[other] > dearest:
            task, dearest = other, late * problem.prices.late[other]
    length = 0
    while task != NOBODY and length < len(plan.order):
        workspace.critical[length] = task
        length += 1
        task = groups.before[task] if groups.passed_to[task] == NOBODY else groups.passed_to[task]
    workspace.length[0] = length
