"""Views: everything that each deciding team may know now."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import entry, kernel
from teamformer.world.phases.beliefs import expected_rest
from teamformer.world.phases.delays import chance_of_delay, may_join
from teamformer.world.phases.formation import is_in_reach, is_in_same_place
from teamformer.world.phases.reach import any_fly, can_go_with, has_to_part
from teamformer.world.rules.constants import NOBODY
from teamformer.world.rules.coverage import fills_gap
from teamformer.world.state.arrays import RUNNING, world_at
from teamformer.world.state.spatial_index import (
    distance_squared,
    find_near,
    forget_cells,
    list_teams_by_cell,
    stands_at,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from teamformer.mission.model import Mission
    from teamformer.world.state.arrays import World, Worlds

NEAREST_TEAMS = 16
NEXT_TASKS = 16
"""How many teams and tasks a view holds at most, so that a decision's cost stays constant."""
FARTHEST = 2.0**38
"""Squared cells times 1024: a sort key has no room for more."""


class View(NamedTuple):
    """What the deciding teams know: one row for each team, in the order of worlds and slots.

    If there are fewer teams or tasks than columns, the remaining columns are padding, with slot or
    task NOBODY (-1) and zeros. Counts say how much of each capability there is, in units. Places
    and lengths are in cells on a grid and in metres on a plane. Divide them by `unit` to have cells
    on both, as learned policies need them.

    The teams in sight are the nearest within the sensing radius. Teams in the same place are
    equally near. Among equally near teams, those come first that bring what the team's own task
    still needs, then those with the same assignment, then those with the nearest slots. The first
    task is the team's own assignment; the other open tasks follow in the shared order. For a task
    without a load, `task_to_place` is its own place. If no task of the batch has a load,
    `task_to_place` has no columns.
    """

    world: Array  # (teams,) int32, index into the batch
    slot: Array  # (teams,) int32, the team's lowest robot
    place: Array  # (teams, 2) float64, where the team is, as (x, y)
    counts: Array  # (teams, caps) int32, what its robots bring together
    size: Array  # (teams,) int32, how many robots it has
    task: Array  # (teams,) int32, the task it heads for, or NOBODY
    is_at_task: Array  # (teams,) bool, whether it is at the place of this task
    is_serving: Array  # (teams,) bool, whether it serves; it must then maintain
    has_to_part: Array  # (teams,) bool, whether it keeps who flies over walls from a task
    rest: Array  # (teams,) int32, steps until its service should end; 0 if it has none
    unit: Array  # (teams,) float32, the length that counts as one cell: 1 on a grid
    arrival_radius: Array  # (teams,) float32, places this near are the same: 0 on a grid
    pace: Array  # (teams,) float32, the length that the team walks in a step
    delay: Array  # (teams,) float32, the probability that it stands still in a step
    seen_slot: Array  # (teams, seen) int32, the slots of the teams in sight
    seen_place: Array  # (teams, seen, 2) float64, where they are
    seen_counts: Array  # (teams, seen, caps) int32, what they bring
    seen_task: Array  # (teams, seen) int32, their assignments or NOBODY
    is_here: Array  # (teams, seen) bool, in the same place as this team
    can_join: Array  # (teams, seen) bool, whether wanting its counts more is legal
    can_go_with: Array  # (teams, seen) bool, whether the union of those here would not have to part
    task_number: Array  # (teams, tasks) int32, the numbers of open tasks
    task_place: Array  # (teams, tasks, 2) float64, where they are
    task_to_place: Array  # (teams, tasks, 2) float64, where loads are brought, or (teams, 0, 2)
    task_needs: Array  # (teams, tasks, caps) int32, what they need, as far as is known
    task_may_need: Array  # (teams, tasks, caps) float32, probability of one more, or (teams, 0, 0)
    task_within: Array  # (teams, tasks) float32, how far off it may be; 0: known; or (teams, 0)
    task_rank: Array  # (teams, tasks) int32, place in the shared order; 0 is the first open task
    first_member: Array  # (teams + 1,) int32, each team's first row in the next two arrays
    member: Array  # (members,) int32, robot numbers, ascending in a team
    member_counts: Array  # (members, caps) int32, what each robot of `member` brings


@entry
def lay_out_rows(worlds: Worlds, first_row: Array, first_member: Array) -> None:
    """Fill in where each world's rows and members begin, as (worlds + 1,)."""
    first_row[0] = first_member[0] = 0
    for w in range(len(worlds.rules)):
        teams = members = 0
        if worlds.count[w].status == RUNNING:
            for slot in range(worlds.rules[w].robots):
                teams += worlds.teams[w, slot].size > 0
                members += worlds.teams[w, slot].size
        first_row[w + 1] = first_row[w] + teams
        first_member[w + 1] = first_member[w] + members


@entry
def fill_views(
    worlds: Worlds, view: View, first_row: Array, first_member: Array, begin: int, end: int
) -> None:
    """Write the views of the running worlds from `begin` to `end`."""
    for w in range(begin, end):
        if worlds.count[w].status != RUNNING:
            continue
        world = world_at(worlds, w)
        list_teams_by_cell(world)
        _write_members(world, view, first_row[w], first_member[w])
        row, is_mixed = first_row[w], any_fly(world)
        for team in range(world.rules.robots):
            if world.teams[team].size > 0:
                view.world[row] = w
                _write_own(world, view, row, team)
                view.has_to_part[row] = is_mixed and has_to_part(world, team)
                _write_seen(world, view, row, team, is_mixed)
                _write_tasks(world, view, row, team)
                row += 1
        forget_cells(world)
    view.first_member[first_row[end]] = first_member[end]


@kernel
def _write_members(world: World, view: View, row: int, member: int) -> None:
    """Write every team's robots: first where each team's begin, then robot by robot."""
    for team in range(world.rules.robots):
        if world.teams[team].size > 0:
            world.teams[team].row = view.first_member[row] = member
            member += world.teams[team].size
            row += 1
    for robot in range(world.rules.robots):
        team = world.robots[robot].team
        if team != NOBODY:
            member = world.teams[team].row
            world.teams[team].row += 1
            view.member[member] = robot
            for cap in range(view.counts.shape[1]):
                view.member_counts[member, cap] = world.brings[robot, cap]


@kernel
def _write_own(world: World, view: View, row: int, team: int) -> None:
    view.slot[row] = team
    view.place[row, 0] = world.teams[team].x
    view.place[row, 1] = world.teams[team].y
    for cap in range(view.counts.shape[1]):
        view.counts[row, cap] = world.has[team, cap]
    view.size[row] = world.teams[team].size
    task = world.teams[team].task
    view.task[row] = task
    view.is_at_task[row] = task != NOBODY and stands_at(world, team, task)
    view.is_serving[row] = world.teams[team].serves > 0
    view.rest[row] = expected_rest(world, team)
    view.unit[row] = world.rules.unit
    view.arrival_radius[row] = world.rules.arrival_radius
    view.pace[row] = world.teams[team].pace
    view.delay[row] = chance_of_delay(world, team)


@kernel
def _write_seen(world: World, view: View, row: int, team: int, is_mixed: bool) -> None:
    found = find_near(world, team, world.rules.sensing_radius)
    kept = _nearest_first(world, team, found, view.seen_slot.shape[1])
    for column in range(view.seen_slot.shape[1]):
        if column >= kept:
            _pad_seen(view, row, column)
            continue
        other = world.near[column]
        view.seen_slot[row, column] = other
        view.seen_place[row, column, 0] = world.teams[other].x
        view.seen_place[row, column, 1] = world.teams[other].y
        for cap in range(view.counts.shape[1]):
            view.seen_counts[row, column, cap] = world.has[other, cap]
        view.seen_task[row, column] = world.teams[other].task
        view.is_here[row, column] = is_in_same_place(world, team, other)
        are_free = may_join(world, team) and may_join(world, other)
        view.can_join[row, column] = are_free and is_in_reach(world, team, other)
        is_asked = is_mixed and view.is_here[row, column]
        view.can_go_with[row, column] = not is_asked or can_go_with(world, team, other)


@kernel
def _pad_seen(view: View, row: int, column: int) -> None:
    view.seen_slot[row, column] = NOBODY
    view.seen_place[row, column, 0] = view.seen_place[row, column, 1] = 0.0
    for cap in range(view.counts.shape[1]):
        view.seen_counts[row, column, cap] = 0
    view.seen_task[row, column] = NOBODY
    view.is_here[row, column] = False
    view.can_join[row, column] = False
    view.can_go_with[row, column] = False


@kernel
def _nearest_first(world: World, team: int, found: int, most: int) -> int:
    """Sort the first `most` of the teams in `world.near` to its front; return how many."""
    kept = 0
    for i in range(found):
        other = world.near[i]
        key = _sort_key(world, team, other)
        if kept == most and (most == 0 or key >= world.near_key[most - 1]):
            continue
        position = min(kept, most - 1)
        while position > 0 and key < world.near_key[position - 1]:
            world.near[position] = world.near[position - 1]
            world.near_key[position] = world.near_key[position - 1]
            position -= 1
        world.near[position], world.near_key[position] = other, key
        kept = min(kept + 1, most)
    return kept


@kernel
def _sort_key(world: World, team: int, other: int) -> int:
    """Return a number that is less for what comes first: near, of help, with a slot close by."""
    away = 0  # all in the same place are equally near
    if not is_in_same_place(world, team, other):
        cells_squared = distance_squared(world, team, other) / world.rules.unit**2
        away = 1 + int(min(cells_squared * 1024, FARTHEST))
    use = 2
    if _helps(world, team, other):
        use = 0 if world.teams[other].task == world.teams[team].task else 1
    slots_apart = 2 * abs(other - team) + (other > team)
    return (away << 24) + (use << 22) + slots_apart


@kernel
def _helps(world: World, team: int, other: int) -> bool:
    """Say whether another team brings something that this team's task still needs."""
    task = world.teams[team].task
    if task == NOBODY:
        return False
    return fills_gap(world.has[team], world.needs[task], world.has[other])


@kernel
def _write_tasks(world: World, view: View, row: int, team: int) -> None:
    own, column, columns = world.teams[team].task, 0, view.task_number.shape[1]
    if own != NOBODY:
        _write_task(world, view, row, column, own)
        column += 1
    position = 0
    while column < columns and position < world.count.open:
        task = world.order[position]
        if task != own:
            _write_task(world, view, row, column, task)
            column += 1
        position += 1
    for padded in range(column, columns):
        view.task_number[row, padded] = NOBODY
        view.task_place[row, padded, 0] = view.task_place[row, padded, 1] = 0.0
        if view.task_to_place.shape[1] > 0:
            view.task_to_place[row, padded, 0] = view.task_to_place[row, padded, 1] = 0.0
        for cap in range(view.counts.shape[1]):
            view.task_needs[row, padded, cap] = 0
        for cap in range(view.task_may_need.shape[2]):
            view.task_may_need[row, padded, cap] = 0.0
        if view.task_within.shape[1] > 0:
            view.task_within[row, padded] = 0.0
        view.task_rank[row, padded] = 0


@kernel
def _write_task(world: World, view: View, row: int, column: int, task: int) -> None:
    view.task_number[row, column] = task
    view.task_place[row, column, 0] = world.tasks[task].x
    view.task_place[row, column, 1] = world.tasks[task].y
    if view.task_to_place.shape[1] > 0:
        is_load = world.tasks[task].is_load
        to_x = world.tasks[task].to_x if is_load else world.tasks[task].x
        to_y = world.tasks[task].to_y if is_load else world.tasks[task].y
        view.task_to_place[row, column, 0], view.task_to_place[row, column, 1] = to_x, to_y
    for cap in range(view.counts.shape[1]):
        view.task_needs[row, column, cap] = world.needs[task, cap]
    for cap in range(view.task_may_need.shape[2]):
        is_hidden = world.tasks[task].hides_needs
        view.task_may_need[row, column, cap] = world.may_need[task, cap] if is_hidden else 0.0
    if view.task_within.shape[1] > 0:
        is_hidden = world.tasks[task].hides_place
        view.task_within[row, column] = world.tasks[task].within if is_hidden else 0.0
    view.task_rank[row, column] = world.tasks[task].rank


def make_view(
    worlds: int,
    robots: int,
    tasks: int,
    caps: int,
    hides_needs: bool = False,
    hides_places: bool = False,
    has_loads: bool = False,
) -> View:
    """Return room for the views of so many worlds of up to these sizes."""
    teams, seen, shown = worlds * robots, min(NEAREST_TEAMS, robots - 1), min(NEXT_TASKS, tasks)
    may_need = (teams, shown, caps) if hides_needs else (teams, 0, 0)
    return View(
        world=np.zeros(teams, dtype=np.int32),
        slot=np.zeros(teams, dtype=np.int32),
        place=np.zeros((teams, 2)),
        counts=np.zeros((teams, caps), dtype=np.int32),
        size=np.zeros(teams, dtype=np.int32),
        task=np.zeros(teams, dtype=np.int32),
        is_at_task=np.zeros(teams, dtype=np.bool_),
        is_serving=np.zeros(teams, dtype=np.bool_),
        has_to_part=np.zeros(teams, dtype=np.bool_),
        rest=np.zeros(teams, dtype=np.int32),
        unit=np.zeros(teams, dtype=np.float32),
        arrival_radius=np.zeros(teams, dtype=np.float32),
        pace=np.zeros(teams, dtype=np.float32),
        delay=np.zeros(teams, dtype=np.float32),
        seen_slot=np.zeros((teams, seen), dtype=np.int32),
        seen_place=np.zeros((teams, seen, 2)),
        seen_counts=np.zeros((teams, seen, caps), dtype=np.int32),
        seen_task=np.zeros((teams, seen), dtype=np.int32),
        is_here=np.zeros((teams, seen), dtype=np.bool_),
        can_join=np.zeros((teams, seen), dtype=np.bool_),
        can_go_with=np.zeros((teams, seen), dtype=np.bool_),
        task_number=np.zeros((teams, shown), dtype=np.int32),
        task_place=np.zeros((teams, shown, 2)),
        task_to_place=np.zeros((teams, shown if has_loads else 0, 2)),
        task_needs=np.zeros((teams, shown, caps), dtype=np.int32),
        task_may_need=np.zeros(may_need, dtype=np.float32),
        task_within=np.zeros((teams, shown if hides_places else 0), dtype=np.float32),
        task_rank=np.zeros((teams, shown), dtype=np.int32),
        first_member=np.zeros(teams + 1, dtype=np.int32),
        member=np.zeros(teams, dtype=np.int32),
        member_counts=np.zeros((teams, caps), dtype=np.int32),
    )


def room_for_views(worlds: Worlds, missions: Sequence[Mission]) -> View:
    """Return room for the views of all teams of a batch."""
    count, robots, caps = worlds.has.shape
    tasks = worlds.needs.shape[1]
    if any(mission.arrivals for mission in missions):  # nobody knows how many
        tasks = max(tasks, NEXT_TASKS)
    return make_view(
        worlds=count,
        robots=robots,
        tasks=tasks,
        caps=caps,
        hides_needs=worlds.may_need.shape[1] > 0,
        hides_places=worlds.spots.shape[1] > 0,
        has_loads=bool(worlds.rules["has_loads"].any()),
    )
