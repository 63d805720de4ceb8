"""What becomes of a plan when it shows what a task needs: who goes on, and who is called when.

Whoever is not needed is left out. Whoever is missing is called: the task is put into the order
where that costs least, in steps that robots walk and wait, at once or later.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from teamformer.jit import kernel
from teamformer.rules.constants import FAR, NOBODY

if TYPE_CHECKING:
    from teamformer.planning.foresight.ground import Ground, Stage
    from teamformer.rules.arrays import Array


@kernel
def find_following(stage: Stage, robot: int) -> None:
    """Find what a robot heads for: what it scouts, or the first task in the order that has it."""
    stage.is_stale[robot] = False
    scouted = stage.scouts[robot]
    if scouted != NOBODY and stage.is_open[scouted] and not stage.is_known[scouted]:
        stage.following[robot] = scouted
        return
    stage.following[robot] = NOBODY
    for position in range(stage.left[0]):
        task = stage.order[position]
        if stage.is_open[task] and stage.is_in[task, robot]:
            stage.following[robot] = task
            return


@kernel
def cells_from(ground: Ground, stage: Stage, robot: int, task: int) -> Any:
    """Return how many cells a robot is away from a task; more than there are if it is cut off."""
    team = stage.team[robot]
    x, y = stage.x[team], stage.y[team]
    most = ground.steps.shape[1] - 1
    if ground.fields.shape[1] > 0:
        return min(most, ground.fields[task, y, x])
    return min(most, abs(ground.spot[task, 0] - x) + abs(ground.spot[task, 1] - y))


@kernel
def answer(ground: Ground, stage: Stage, task: int, needs: Array, now: int) -> None:
    """Change the plan for a task of which it is known now what it needs; `needs` (tasks, caps)."""
    robots, caps = ground.counts.shape
    for cap in range(caps):
        stage.short[cap] = needs[task, cap]
        for robot in range(robots):
            if stage.is_in[task, robot]:
                stage.short[cap] -= ground.counts[robot, cap]
    _leave_out(ground, stage, task, needs)
    is_short = False
    for cap in range(caps):
        is_short |= stage.short[cap] > 0
    if is_short:
        _call(ground, stage, task, needs, now)
    for robot in range(robots):
        stage.is_stale[robot] = True


@kernel
def _leave_out(ground: Ground, stage: Stage, task: int, needs: Array) -> None:
    """Leave out who is not needed: who has things to do before first, then the farthest."""
    while True:
        last, latest = NOBODY, -1
        for robot in range(len(stage.team)):
            if not stage.is_in[task, robot] or not _is_spare(ground, stage, task, robot, needs):
                continue
            away = cells_from(ground, stage, robot, task)
            if stage.following[robot] != task:
                away += FAR
            if away > latest:
                last, latest = robot, away
        if last == NOBODY:
            return
        stage.is_in[task, last] = False
        for cap in range(needs.shape[1]):
            stage.short[cap] += ground.counts[last, cap]


@kernel
def _is_spare(ground: Ground, stage: Stage, task: int, robot: int, needs: Array) -> bool:
    """Say whether nothing that is needed would be missing without a robot that is not already."""
    for cap in range(needs.shape[1]):
        has = ground.counts[robot, cap]
        if needs[task, cap] > 0 and has > 0 and stage.short[cap] + has > 0:
            return False
    return True


@kernel
def _leg(ground: Ground, stage: Stage, robot: int, before: int, task: int) -> Any:
    """Return the steps from a robot's last task to another one; from where it is if it has none."""
    if before == NOBODY:
        return ground.steps[ground.pace[robot], cells_from(ground, stage, robot, task)]
    return ground.steps[ground.pace[robot], ground.cells[task, before]]


@kernel
def _call(ground: Ground, stage: Stage, task: int, needs: Array, now: int) -> None:
    """Put a task to where in the order, and call to it, what costs least."""
    _take_out(stage, task)
    _look_along(ground, stage, now)
    best, best_cost = 0, FAR * 100
    for position in range(stage.left[0]):
        cost = _cost_at(ground, stage, task, position, needs)
        if cost < best_cost:
            best, best_cost = position, cost
        if position < stage.left[0] - 1:
            _pass(ground, stage, stage.order[position])
    _look_along(ground, stage, now)
    for position in range(best):
        _pass(ground, stage, stage.order[position])
    _cost_at(ground, stage, task, best, needs)
    for robot in range(len(stage.team)):
        stage.is_in[task, robot] = stage.is_called[robot]
    for position in range(stage.left[0] - 1, best, -1):
        stage.order[position] = stage.order[position - 1]
        stage.rank[stage.order[position]] = position
    stage.order[best], stage.rank[task] = task, best


@kernel
def _take_out(stage: Stage, task: int) -> None:
    """Order the open tasks anew: without gaps, and the one at hand last."""
    kept = 0
    for position in range(stage.left[0]):
        other = stage.order[position]
        if stage.is_open[other] and other != task:
            stage.order[kept], stage.rank[other] = other, kept
            kept += 1
    stage.order[kept], stage.rank[task] = task, kept
    stage.left[0] = kept + 1


@kernel
def _look_along(ground: Ground, stage: Stage, now: int) -> None:
    """Find each robot's first task from every position on, and begin at the first."""
    tasks = stage.left[0] - 1
    for robot in range(len(stage.team)):
        stage.before[robot] = NOBODY
        stage.when[robot] = max(now, stage.busy[stage.team[robot]])
        stage.after[tasks, robot] = NOBODY
    for position in range(tasks - 1, -1, -1):
        other = stage.order[position]
        for robot in range(len(stage.team)):
            if stage.is_in[other, robot]:
                stage.after[position, robot] = other
            else:
                stage.after[position, robot] = stage.after[position + 1, robot]


@kernel
def _pass(ground: Ground, stage: Stage, other: int) -> None:
    """Let those who do a task have done it."""
    latest = 0
    for robot in range(len(stage.team)):
        if stage.is_in[other, robot]:
            there = stage.when[robot] + _leg(ground, stage, robot, stage.before[robot], other)
            latest = max(latest, there)
    for robot in range(len(stage.team)):
        if stage.is_in[other, robot]:
            stage.when[robot] = latest + ground.expected[other]
            stage.before[robot] = other


@kernel
def _cost_at(ground: Ground, stage: Stage, task: int, position: int, needs: Array) -> Any:
    """Return what a task costs at a position in steps walked and waited; note who is called."""
    robots = len(stage.team)
    for robot in range(robots):
        way = _leg(ground, stage, robot, stage.before[robot], task)
        stage.there[robot], stage.detour[robot] = stage.when[robot] + way, way
        then = stage.after[position, robot]
        if then != NOBODY:
            stage.detour[robot] += ground.steps[ground.pace[robot], ground.cells[then, task]]
            stage.detour[robot] -= _leg(ground, stage, robot, stage.before[robot], then)
        stage.is_called[robot] = stage.is_in[task, robot]
    for cap in range(needs.shape[1]):
        lacking = needs[task, cap]
        for robot in range(robots):
            if stage.is_called[robot]:
                lacking -= ground.counts[robot, cap]
        while lacking > 0:
            chosen, least = NOBODY, FAR
            for robot in range(robots):
                if ground.counts[robot, cap] == 0 or stage.is_called[robot]:
                    continue
                if stage.there[robot] + stage.detour[robot] < least:
                    chosen, least = robot, stage.there[robot] + stage.detour[robot]
            if chosen == NOBODY:
                return FAR * 10
            stage.is_called[chosen] = True
            lacking -= ground.counts[chosen, cap]
    latest, cost = 0, 0
    for robot in range(robots):
        if stage.is_called[robot]:
            latest = max(latest, stage.there[robot])
    for robot in range(robots):
        if stage.is_called[robot]:
            cost += stage.detour[robot] + latest - stage.there[robot]
    return cost
