"""A plan played step by step in one future, as teams would follow it; forming is counted.

Teams part, walk, wait and join by the plan, and do what they stand at and can do. When a team comes
to a task that nobody has seen before, it shows what that needs, and `recourse` says who goes on and
who is called. Nothing else is planned anew.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from teamformer.jit import kernel
from teamformer.planning.distances import UNREACHABLE
from teamformer.planning.foresight.recourse import answer, find_following
from teamformer.planning.steps import next_cell
from teamformer.rules.constants import NOBODY, ROUNDING

if TYPE_CHECKING:
    from teamformer.planning.foresight.ground import Ground, Stage
    from teamformer.planning.teams.plan import TeamPlan
    from teamformer.rules.arrays import Array

IMPOSSIBLE = 2**40
"""What a future costs in which some task is never done."""

STEP = 8
"""What a step of makespan costs for each task; a step of the end of any task costs one."""

LONGEST = 100_000
"""No play takes more steps."""


@kernel
def play(
    ground: Ground, plan: TeamPlan, scouts: Array, needs: Array, duration: Array, stage: Stage
) -> Any:  # fmt: skip
    """Return what a plan costs in a future, a whole number: the makespan, and the ends of tasks.

    `scouts` (robots,) holds the task that each robot looks at first, or NOBODY; `needs` (tasks,
    caps) and `duration` (tasks,) are what is true.
    """
    begin_play(ground, plan, scouts, stage)
    tasks = len(plan.order)
    now, left, makespan, total = ground.now[0], tasks, ground.now[0], 0
    last = now + LONGEST
    while left > 0:
        any_moves = _form(ground, stage, now)
        now += 1
        for team in range(len(stage.team)):
            if stage.team[team] == team and stage.is_touched[team]:
                _show(ground, stage, team, needs, now)
        for team in range(len(stage.team)):
            if stage.team[team] != team or not stage.is_touched[team]:
                continue
            task = ground.first_here[stage.y[team], stage.x[team]]
            while task != NOBODY:
                if stage.is_open[task] and _can_do(ground, stage, team, task, needs):
                    end = now + duration[task]
                    stage.is_open[task] = False
                    stage.busy[team] = max(stage.busy[team], end)
                    makespan, total, left = max(makespan, end), total + end, left - 1
                task = ground.next_here[task]
        is_stuck = not any_moves and now > ground.now[0] + 1  # all look around in the first step
        if is_stuck or now > last:
            return IMPOSSIBLE
    return STEP * tasks * (makespan - ground.now[0]) + total - tasks * ground.now[0]


@kernel
def begin_play(ground: Ground, plan: TeamPlan, scouts: Array, stage: Stage) -> None:
    """Put a plan on the stage, and everybody where they are."""
    robots = len(stage.team)
    for task in range(len(plan.order)):
        stage.order[task] = plan.order[task]
        stage.rank[plan.order[task]] = task
        stage.is_open[task] = True
        stage.is_known[task] = not ground.is_hidden[task]
        for robot in range(robots):
            stage.is_in[task, robot] = False
        for seat in range(plan.size[task]):
            stage.is_in[task, plan.coalition[task, seat]] = True
    stage.left[0] = len(plan.order)
    for robot in range(robots):
        stage.team[robot] = ground.company[robot]
        stage.x[robot], stage.y[robot] = ground.start[robot, 0], ground.start[robot, 1]
        stage.credit[robot] = 0.0
        stage.busy[robot] = ground.ready[robot]
        stage.following[robot], stage.is_stale[robot] = NOBODY, True
        stage.scouts[robot] = scouts[robot]


@kernel
def _form(ground: Ground, stage: Stage, now: int) -> bool:
    """Let teams part, join or walk; say whether any does so or still serves."""
    robots, any_moves = len(stage.team), False
    for robot in range(robots):
        stage.has_formed[robot] = False
        stage.is_touched[robot] = now == ground.now[0]
        task = stage.following[robot]
        if stage.is_stale[robot] or (task != NOBODY and not stage.is_open[task]):
            find_following(stage, robot)
            task = stage.following[robot]
        if task != NOBODY:
            stage.waiting[task] = NOBODY
    for team in range(robots):
        if stage.team[team] != team or stage.has_formed[team]:
            continue
        if stage.busy[team] > now:
            any_moves = True
            continue
        if _is_parting(stage, team):
            _part(stage, team)
            any_moves = True
            continue
        task = stage.following[team]
        if task == NOBODY:
            continue
        to_go = _way(ground, stage, team, task)
        if to_go >= UNREACHABLE:
            continue
        if to_go > 0:
            _walk(ground, stage, team, task, to_go)
            any_moves = True
            continue
        other = stage.waiting[task]
        if other == NOBODY:
            stage.waiting[task] = team
            continue
        stage.waiting[task] = NOBODY
        _join(stage, other, team)
        any_moves = True
    return any_moves


@kernel
def _is_parting(stage: Stage, team: int) -> bool:
    for robot in range(team + 1, len(stage.team)):
        if stage.team[robot] == team and stage.following[robot] != stage.following[team]:
            return True
    return False


@kernel
def _part(stage: Stage, team: int) -> None:
    """Let the robots of a team that head for its earliest task part from the others."""
    robots, task = len(stage.team), NOBODY
    for robot in range(team, robots):
        if stage.team[robot] == team:
            other = stage.following[robot]
            if other != NOBODY and (task == NOBODY or stage.rank[other] < stage.rank[task]):
                task = other
    stays = goes = NOBODY
    x, y = stage.x[team], stage.y[team]
    for robot in range(team, robots):
        if stage.team[robot] != team:
            continue
        if stage.following[robot] == task:
            stays = robot if stays == NOBODY else stays
            stage.team[robot] = stays
        else:
            goes = robot if goes == NOBODY else goes
            stage.team[robot] = goes
    for part in (stays, goes):
        stage.x[part], stage.y[part] = x, y
        stage.credit[part], stage.busy[part] = 0.0, 0
        stage.has_formed[part] = True


@kernel
def _join(stage: Stage, team: int, other: int) -> None:
    """Let two teams in one place be one, at the lower robot."""
    for robot in range(other, len(stage.team)):
        if stage.team[robot] == other:
            stage.team[robot] = team
    stage.credit[team] = 0.0
    stage.has_formed[team] = stage.is_touched[team] = True


@kernel
def _way(ground: Ground, stage: Stage, team: int, task: int) -> Any:
    """Return how many cells a team is away from a task."""
    if ground.fields.shape[1] > 0:
        return ground.fields[task, stage.y[team], stage.x[team]]
    away = abs(ground.spot[task, 0] - stage.x[team]) + abs(ground.spot[task, 1] - stage.y[team])
    return away


@kernel
def _walk(ground: Ground, stage: Stage, team: int, task: int, to_go: int) -> None:
    """Walk a step; parting and walking in one step is left out where forming costs nothing."""
    speed = ground.speed[team]
    for robot in range(team + 1, len(stage.team)):
        if stage.team[robot] == team:
            speed = min(speed, ground.speed[robot])
    stage.credit[team] += speed
    cells = int(stage.credit[team] + ROUNDING)
    stage.credit[team] -= cells
    if cells >= to_go:
        cells, stage.credit[team] = to_go, 0.0
    for _ in range(cells):
        x, y = next_cell(
            ground.fields, ground.fields.shape[1] > 0, task, stage.x[team], stage.y[team],
            ground.spot[task, 0], ground.spot[task, 1],
        )  # fmt: skip
        stage.x[team], stage.y[team] = x, y
    stage.is_touched[team] = cells > 0


@kernel
def _show(ground: Ground, stage: Stage, team: int, needs: Array, now: int) -> None:
    """Make known what the open tasks need that a team has come to."""
    task = ground.first_here[stage.y[team], stage.x[team]]
    while task != NOBODY:
        if stage.is_open[task] and not stage.is_known[task]:
            stage.is_known[task] = True
            answer(ground, stage, task, needs, now)
        task = ground.next_here[task]


@kernel
def _can_do(ground: Ground, stage: Stage, team: int, task: int, needs: Array) -> bool:
    for cap in range(needs.shape[1]):
        lacking = needs[task, cap]
        if lacking > 0:
            for robot in range(team, len(stage.team)):
                if stage.team[robot] == team:
                    lacking -= ground.counts[robot, cap]
            if lacking > 0:
                return False
    return True
