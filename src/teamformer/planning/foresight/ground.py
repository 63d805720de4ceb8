"""Where plans are played: the present as arrays, and room to play in."""

from __future__ import annotations

from collections.abc import Set
from typing import NamedTuple

import numpy as np

from teamformer.grid import Grid
from teamformer.model import Scenario
from teamformer.planning.distances import distance_fields
from teamformer.planning.relaxation.plan import Array
from teamformer.planning.teams.facts import Facts, Situation
from teamformer.rules.constants import NOBODY


class Ground(NamedTuple):
    """What is the same in every future; tasks and robots are those of a `Situation`."""

    now: Array  # (1,) steps made
    forming: Array  # (1,) steps that forming costs
    fields: Array  # (tasks, height, width) cells to each task; no cells where nothing is blocked
    spot: Array  # (tasks, 2) x and y
    first_here: Array  # (height, width) a task in each cell, or NOBODY
    next_here: Array  # (tasks,) another one in the same cell, or NOBODY
    start: Array  # (robots, 2)
    company: Array  # (robots,) the lowest robot of the team that each is in
    ready: Array  # (robots,) the step from which each is free
    speed: Array  # (robots,) cells a step
    counts: Array  # (robots, caps)
    cells: Array  # (tasks, places) as in `Relaxed`
    steps: Array  # (paces, cells) as in `Relaxed`
    pace: Array  # (robots,) as in `Relaxed`
    expected: Array  # (tasks,) steps that each is believed to take
    is_hidden: Array  # (tasks,) whether nobody knows yet what it needs


def ground_of(scenario: Scenario, situation: Situation, facts: Facts, hidden: Set[int]) -> Ground:
    """Return the present of a mission on a grid; of `hidden` tasks nobody knows what they need."""
    world, problem = scenario.world, situation.problem
    assert isinstance(world, Grid)
    spots = [scenario.tasks[task].at for task in situation.tasks]
    first_here = np.full((world.height, world.width), NOBODY, np.int64)
    next_here = np.full(len(spots), NOBODY, np.int64)
    for task in range(len(spots) - 1, -1, -1):
        x, y = int(spots[task][0]), int(spots[task][1])
        next_here[task], first_here[y, x] = first_here[y, x], task
    no_fields = np.zeros((len(spots), 0, 0), np.int32)
    return Ground(
        now=np.array([facts.step]),
        forming=np.array([situation.forming_steps]),
        fields=distance_fields(world, spots) if world.rows else no_fields,
        spot=np.array(spots, np.int64).reshape(-1, 2),
        first_here=first_here,
        next_here=next_here,
        start=np.array([facts.places[robot] for robot in situation.robots], np.int64),
        company=situation.company,
        ready=problem.ready.astype(np.int64),
        speed=problem.speed,
        counts=problem.counts.astype(np.int64),
        cells=problem.cells,
        steps=problem.steps,
        pace=problem.pace,
        expected=problem.duration.astype(np.int64),
        is_hidden=np.array([task in hidden for task in situation.tasks]),
    )


class Stage(NamedTuple):
    """Room to play a plan in; what is said of a team stands at its lowest robot."""

    x: Array  # (robots,) of each team
    y: Array  # (robots,)
    credit: Array  # (robots,) fractions of a cell that a team may walk
    busy: Array  # (robots,) the step until which a team serves
    has_formed: Array  # (robots,) in this step
    is_touched: Array  # (robots,) has come somewhere, or has formed
    team: Array  # (robots,) the lowest robot of the team that each is in
    following: Array  # (robots,) the task that each heads for, or NOBODY
    is_stale: Array  # (robots,) has to look what that is
    scouts: Array  # (robots,) a task that each looks at first, or NOBODY
    order: Array  # (tasks,) the first `left` of them are open
    left: Array  # (1,)
    rank: Array  # (tasks,)
    is_open: Array  # (tasks,) neither done nor being served
    is_known: Array  # (tasks,) whether it is known what it needs
    is_in: Array  # (tasks, robots) who does it
    waiting: Array  # (tasks,) a team that waits there to be joined in this step
    before: Array  # (robots,) the last task on each way, or NOBODY
    after: Array  # (tasks + 1, robots) the first task from a position on, or NOBODY
    when: Array  # (robots,) until when each is on its way
    detour: Array  # (robots,) what a task costs each, in steps
    there: Array  # (robots,) when each is there
    is_called: Array  # (robots,)
    short: Array  # (caps,) what is lacking


def empty_stage(ground: Ground) -> Stage:
    """Return room to play the plans of a moment in."""
    robots, caps = ground.counts.shape
    tasks = len(ground.spot)

    def whole(*shape: int) -> Array:
        return np.zeros(shape, np.int64)

    def flags(*shape: int) -> Array:
        return np.zeros(shape, np.bool_)

    return Stage(
        x=whole(robots), y=whole(robots), credit=np.zeros(robots), busy=whole(robots),
        has_formed=flags(robots), is_touched=flags(robots), team=whole(robots),
        following=whole(robots), is_stale=flags(robots), scouts=whole(robots),
        order=whole(tasks), left=whole(1), rank=whole(tasks), is_open=flags(tasks),
        is_known=flags(tasks), is_in=flags(tasks, robots), waiting=whole(tasks),
        before=whole(robots), after=whole(tasks + 1, robots), when=whole(robots),
        detour=whole(robots), there=whole(robots), is_called=flags(robots), short=whole(caps),
    )  # fmt: skip
