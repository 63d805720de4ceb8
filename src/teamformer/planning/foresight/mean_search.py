"""A plan is changed as long as it gets better on average over the same sampled futures."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from teamformer.jit import entry, kernel
from teamformer.planning.foresight.play import STEP, begin_play, play
from teamformer.planning.foresight.recourse import answer, cells_from
from teamformer.planning.relaxation.insertion import draw_below
from teamformer.planning.teams.neighbourhood import change_plan, keep, undo
from teamformer.rules.constants import NOBODY

if TYPE_CHECKING:
    from teamformer.planning.foresight.futures import Futures
    from teamformer.planning.foresight.ground import Ground, Stage
    from teamformer.planning.relaxation.problem import Relaxed
    from teamformer.planning.teams.neighbourhood import Bench
    from teamformer.planning.teams.plan import TeamPlan
    from teamformer.rules.arrays import Array

SLACK = 3
"""A change is given up once it has cost so many steps of makespan more, over all futures so far."""

SCOUTING = 6
"""Every so many-th change is about a scout."""


DRAWS = 8
"""How often a task for a scout is drawn at most."""


@kernel
def _cost_in_all(
    ground: Ground, plan: TeamPlan, scouts: Array, futures: Futures, stage: Stage, costs: Array
) -> int:
    """Write what a plan costs in each future, `costs` (futures,); return the sum."""
    total = 0
    for future in range(len(costs)):
        needs, duration = futures.needs[future], futures.duration[future]
        costs[future] = play(ground, plan, scouts, needs, duration, stage)
        total += costs[future]
    return total


@entry
def improve_on_average(
    ground: Ground, problem: Relaxed, plan: TeamPlan, scouts: Array, futures: Futures,
    stage: Stage, bench: Bench, costs: Array, rounds: int, sends_scouts: bool,
) -> int:  # fmt: skip
    """Try changes for a number of rounds and keep those that cost no more; return the sum left.

    `problem` has the needs that are sure: coalitions always cover these. `costs` (2, futures) is
    room for what the plan costs and what the change at hand does. Without any round the plan
    stays as it is.
    """
    total = _cost_in_all(ground, plan, scouts, futures, stage, costs[0])
    for _ in range(rounds):
        if sends_scouts and draw_below(bench.random, SCOUTING) == 0:
            more = _change_scout(ground, plan, scouts, futures, stage, bench, costs)
        else:
            more = _change_plan(ground, problem, plan, scouts, futures, stage, bench, costs)
        if more <= 0:
            total += more
            for future in range(costs.shape[1]):
                costs[0, future] = costs[1, future]
    return total


@kernel
def _change_plan(
    ground: Ground, problem: Relaxed, plan: TeamPlan, scouts: Array, futures: Futures,
    stage: Stage, bench: Bench, costs: Array,
) -> Any:  # fmt: skip
    """Change a plan unless that costs more; return how much more it would."""
    more = 1
    if change_plan(problem, plan, bench):
        more = _more_than(ground, plan, scouts, futures, stage, costs)
    if more > 0:
        undo(plan, bench)
    else:
        keep(bench)
    return more


@kernel
def _change_scout(
    ground: Ground, plan: TeamPlan, scouts: Array, futures: Futures, stage: Stage, bench: Bench,
    costs: Array,
) -> Any:  # fmt: skip
    """Send a scout if that costs less, or none if that costs no more; return how much more."""
    robot = draw_below(bench.random, len(scouts))
    kept, task = scouts[robot], _draw_hidden(ground, bench, robot)
    if kept == NOBODY and task == NOBODY:
        return 1
    scouts[robot] = task if kept == NOBODY else NOBODY
    more = _more_than(ground, plan, scouts, futures, stage, costs)
    if kept == NOBODY and more == 0:
        more = 1
    if more > 0:
        scouts[robot] = kept
    return more


@kernel
def _draw_hidden(ground: Ground, bench: Bench, robot: int) -> int:
    """Draw a task that a robot can get to and nobody has seen; NOBODY if a few draws find none."""
    tasks, no_way = len(ground.is_hidden), ground.steps.shape[1] - 1
    for _ in range(DRAWS):
        task = draw_below(bench.random, tasks)
        if ground.is_hidden[task] and ground.cells[task, tasks + robot] < no_way:
            return task
    return NOBODY


@kernel
def _more_than(
    ground: Ground, plan: TeamPlan, scouts: Array, futures: Futures, stage: Stage, costs: Array
) -> Any:
    """Return how much more a plan costs than `costs[0]` says; roughly, if it is a lot."""
    more, most = 0, SLACK * STEP * len(plan.order)
    for future in range(costs.shape[1]):
        needs, duration = futures.needs[future], futures.duration[future]
        costs[1, future] = play(ground, plan, scouts, needs, duration, stage)
        more += costs[1, future] - costs[0, future]
        if more > most:
            break
    return more


@entry
def amend(ground: Ground, plan: TeamPlan, scouts: Array, needs: Array, stage: Stage) -> None:
    """Change an old plan for what has just shown; `needs` (tasks, caps) are those that are known.

    That is where a robot stands at a task now, or somebody is missing.
    """
    begin_play(ground, plan, scouts, stage)
    for position in range(len(plan.order)):
        task = plan.order[position]
        if stage.is_known[task] and _is_news(ground, stage, task, needs):
            answer(ground, stage, task, needs, ground.now[0])
    for position in range(len(plan.order)):
        task = stage.order[position]
        plan.order[position] = task
        plan.size[task] = 0
        for robot in range(len(scouts)):
            if stage.is_in[task, robot]:
                plan.coalition[task, plan.size[task]] = robot
                plan.size[task] += 1


@kernel
def _is_news(ground: Ground, stage: Stage, task: int, needs: Array) -> bool:
    for robot in range(len(stage.team)):
        if cells_from(ground, stage, robot, task) == 0:
            return True
    for cap in range(needs.shape[1]):
        lacking = needs[task, cap]
        for robot in range(len(stage.team)):
            if stage.is_in[task, robot]:
                lacking -= ground.counts[robot, cap]
        if lacking > 0:
            return True
    return False
