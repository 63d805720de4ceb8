"""Completion: which tasks are done, called off or missed, and what that changes for everybody."""

from __future__ import annotations

from typing import TYPE_CHECKING

from teamformer.base.kernels.jit import kernel
from teamformer.world.phases.assignment import can_do_alone
from teamformer.world.phases.beliefs import expect_end
from teamformer.world.phases.carrying import (
    carried_for,
    carries_in_time,
    expect_arrival,
    is_delivered,
    note_place,
)
from teamformer.world.phases.delays import is_in_shift
from teamformer.world.phases.energy import has_enough
from teamformer.world.phases.room import count_services, has_room, next_in_queue, take_room
from teamformer.world.phases.task_order import close_gaps_in_order
from teamformer.world.rules.constants import NEVER, NOBODY
from teamformer.world.state.arrays import (
    BROKEN_OFF,
    CANCELLED,
    DONE,
    INSIDE,
    UNLOADS,
)
from teamformer.world.state.spatial_index import find_tasks_here, stands_at

if TYPE_CHECKING:
    from teamformer.world.state.arrays import World


@kernel
def complete_tasks(world: World, step: int) -> None:
    """Phase 7: teams do the tasks they stand at and cover; services go on, begin or break off."""
    done_before = world.count.done
    for position in range(world.count.open):
        task = world.order[position]
        if world.tasks[task].server != NOBODY:
            _serve(world, world.tasks[task].server, task, step)
    for team in range(world.rules.robots):
        if world.teams[team].size == 0 or world.teams[team].charger != NOBODY:
            continue
        if world.rules.has_loads and _is_loaded(world, team, step):
            continue
        for i in range(find_tasks_here(world, team)):
            task = world.here[i]
            is_bound = world.tasks[task].is_load or world.tasks[task].is_in_zone
            is_free = not is_bound and _is_free(world, task, step)
            is_free = is_free and (task == world.teams[team].task or has_enough(world, team, task))
            if is_free and can_do_alone(world, team, task) and _fits(world, team, task, step):
                _begin(world, team, task, step)
    if len(world.zones) > 0:
        _enter_zones(world, step)
    if world.count.done > done_before:
        close_gaps_in_order(world)
        _drop_assignments_to_over(world)


@kernel
def _enter_zones(world: World, step: int) -> None:
    """Let tasks in zones begin in the order, where there is room for those before them, too.

    Each is begun by a team that is assigned to it, the lowest of those that can.
    """
    count_services(world)
    if world.rules.has_loads:
        _unload_in_zones(world, step)
    for position in range(world.count.open):
        task = world.order[position]
        if not world.tasks[task].is_in_zone or not world.tasks[task].is_open:
            continue
        if world.tasks[task].server != NOBODY:
            continue
        team = _who_enters(world, task, step)
        if team != NOBODY:
            _begin(world, team, task, step)
        is_waiting = team == NOBODY and world.tasks[task].is_awaited
        if is_waiting or world.tasks[task].server != NOBODY:
            take_room(world, task, INSIDE)


@kernel
def _unload_in_zones(world: World, step: int) -> None:
    """Let loads be unloaded that are where they are brought to: who came first is first.

    Who goes on waiting takes room, too: nobody begins there before.
    """
    task = next_in_queue(world, NOBODY, NOBODY)
    while task != NOBODY:
        came = world.tasks[task].came_at
        if has_room(world, task, UNLOADS):
            world.tasks[task].came_at = NOBODY
            world.tasks[task].is_unloading = True
            world.tasks[task].served = 1
            if world.tasks[task].unload == 0:
                _unload(world, world.tasks[task].server, task, step)
            else:
                expect_arrival(world, world.tasks[task].server, task)
        if world.tasks[task].server != NOBODY:
            take_room(world, task, UNLOADS)
        task = next_in_queue(world, came, task)


@kernel
def _who_enters(world: World, task: int, step: int) -> int:
    """Return the team that begins a task in a zone; NOBODY if none does."""
    is_load = world.tasks[task].is_load
    if is_load and world.tasks[task].is_carried:
        return NOBODY
    if not (has_room(world, task, INSIDE) and _is_free(world, task, step)):
        return NOBODY
    for team in range(world.rules.robots):
        if world.teams[team].size == 0 or world.teams[team].task != task:
            continue
        if world.teams[team].charger != NOBODY or (is_load and world.teams[team].serves > 0):
            continue
        is_able = stands_at(world, team, task) and can_do_alone(world, team, task)
        if is_able and _fits(world, team, task, step):
            return team
    return NOBODY


@kernel
def cancel_tasks(world: World, step: int) -> bool:
    """Call off the tasks that are cancelled in this step (phase 6); say whether any is.

    Who serves one is free; a load is let go of.
    """
    cancelled_before = world.count.cancelled
    for task in range(world.rules.tasks):
        if world.tasks[task].cancelled != step or is_done_or_missed(world, task):
            continue
        world.count.cancelled += 1
        _let_go(world, task)
        _close(world, task, step)
    if world.count.cancelled == cancelled_before:
        return False
    world.count.news |= CANCELLED
    close_gaps_in_order(world)
    _drop_assignments_to_over(world)
    return True


@kernel
def _is_loaded(world: World, team: int, step: int) -> bool:
    """Let a team take up the load that it has come for; say whether it has one.

    It then does nothing else. Nobody takes up a load on the way to something else.
    """
    task = world.teams[team].task
    if task == NOBODY or not world.tasks[task].is_load:
        return False
    if world.teams[team].serves > 0:
        return bool(world.tasks[task].server == team)
    is_free = _is_free(world, task, step) and not world.tasks[task].is_carried
    if is_free and stands_at(world, team, task) and can_do_alone(world, team, task):
        if not carries_in_time(world, team, task, step):
            _miss(world, task, step)
        elif not world.tasks[task].is_in_zone and _fits(world, team, task, step):
            _begin(world, team, task, step)
            return True
    return False


@kernel
def _is_free(world: World, task: int, step: int) -> bool:
    """Say whether a task may begin in a step."""
    may_begin = world.tasks[task].awaits == 0 and world.tasks[task].opens < step
    is_free = world.tasks[task].is_open and may_begin and world.tasks[task].server == NOBODY
    return is_free and _ends_in_time(world, task, step)


@kernel
def _ends_in_time(world: World, task: int, step: int) -> bool:
    """Say whether a task that begins in a step ends before the mission does, as far as is known.

    Of a load the way is not counted, as that depends on who carries it.
    """
    takes = world.tasks[task].duration + world.tasks[task].unload
    return bool(world.rules.until == NEVER or step + takes <= world.rules.until)


@kernel
def miss_tasks(world: World, step: int) -> None:
    """At the end of a step, let tasks be missed that nobody can end by the end of the mission."""
    is_over, any_missed = step >= world.rules.until, False
    for task in range(world.rules.tasks):
        any_missed |= world.tasks[task].missed_at == step  # a load, before whoever came for it
        if is_done_or_missed(world, task) or world.tasks[task].cancelled <= step:
            continue
        is_waiting = world.tasks[task].is_open and world.tasks[task].server == NOBODY
        begins = max(step, world.tasks[task].opens) + 1
        if is_over or (is_waiting and not _ends_in_time(world, task, begins)):
            _miss(world, task, step)
            any_missed = True
    if any_missed:
        close_gaps_in_order(world)
        _drop_assignments_to_over(world)


@kernel
def is_done_or_missed(world: World, task: int) -> bool:
    """Say whether a task is over without being called off."""
    return world.tasks[task].done_at != NOBODY or world.tasks[task].missed_at != NOBODY


@kernel
def _miss(world: World, task: int, step: int) -> None:
    world.tasks[task].missed_at = step
    world.count.missed += 1
    _let_go(world, task)
    _close(world, task, step)


@kernel
def _let_go(world: World, task: int) -> None:
    """End the service of a task that is not done any more; a load is set down."""
    if world.tasks[task].server != NOBODY:
        _end_service(world, world.tasks[task].server, task)
    world.tasks[task].is_carried = False


@kernel
def _fits(world: World, team: int, task: int, step: int) -> bool:
    """Say whether a task that begins in a step fits, as it is believed, into shifts of all."""
    if not world.rules.has_shifts:
        return True
    takes = world.tasks[task].duration
    if world.tasks[task].is_load:
        takes += carried_for(world, team, task)
    return is_in_shift(world, team, step, step + takes)


@kernel
def _goes_on(world: World, team: int, task: int, step: int) -> bool:
    """Say whether a team has all that the task needs which it serves, in the shifts it began in."""
    is_able = can_do_alone(world, team, task)
    return is_able and is_in_shift(world, team, world.tasks[task].begun_at, step)


@kernel
def _serve(world: World, team: int, task: int, step: int) -> None:
    """One step of service; a team that has lost what the task needs breaks it off.

    So does one of which a shift is over, or that is carried away: its motion may come from outside.
    """
    world.tasks[task].served += 1
    if world.tasks[task].is_carried:
        _carry(world, team, task, step)
    elif not (_goes_on(world, team, task, step) and stands_at(world, team, task)):
        _end_service(world, team, task)
        world.count.news |= BROKEN_OFF
    elif world.tasks[task].is_load:
        _load(world, team, task, step)
    elif world.tasks[task].served == world.tasks[task].takes:
        _end_service(world, team, task)
        _finish(world, team, task, step)
    else:
        expect_end(world, task)


@kernel
def _load(world: World, team: int, task: int, step: int) -> None:
    """One step of loading; the load is under way once it was the last."""
    if world.tasks[task].served == world.tasks[task].takes:
        _take_up(world, team, task, step)
    else:
        expect_end(world, task)
        expect_arrival(world, team, task)


@kernel
def _take_up(world: World, team: int, task: int, step: int) -> None:
    world.tasks[task].is_carried = True
    world.tasks[task].taken_at = step
    world.tasks[task].expected = 0
    world.tasks[task].served = 1
    _carry(world, team, task, step)


@kernel
def _carry(world: World, team: int, task: int, step: int) -> None:
    """The end of a step with a load; a team that has lost what it takes lets go of it.

    So does one of which a shift is over.
    """
    if not _goes_on(world, team, task, step):
        note_place(world, task, world.teams[team].x, world.teams[team].y)
        _end_service(world, team, task)
        world.count.news |= BROKEN_OFF
    elif is_delivered(world, team, task, step):
        _unload(world, team, task, step)
    else:
        expect_arrival(world, team, task)


@kernel
def _unload(world: World, team: int, task: int, step: int) -> None:
    """Let a load be where it is brought to, unloaded."""
    world.tasks[task].is_carried = False
    _end_service(world, team, task)
    _finish(world, team, task, step)


@kernel
def _end_service(world: World, team: int, task: int) -> None:
    world.tasks[task].server = NOBODY
    world.tasks[task].is_unloading, world.tasks[task].came_at = False, NOBODY
    world.teams[team].serves -= 1


@kernel
def _begin(world: World, team: int, task: int, step: int) -> None:
    is_load = world.tasks[task].is_load
    if world.tasks[task].takes == 0 and not is_load:
        _finish(world, team, task, step)
        return
    world.tasks[task].server = team
    world.tasks[task].served, world.tasks[task].begun_at = 0, step
    world.tasks[task].expected = max(1, world.tasks[task].duration)
    world.teams[team].serves += 1
    world.teams[team].credit = 0.0
    if is_load and world.tasks[task].takes == 0:
        _take_up(world, team, task, step)
    elif is_load:
        expect_arrival(world, team, task)


@kernel
def _finish(world: World, team: int, task: int, step: int) -> None:
    world.tasks[task].done_at = step
    world.tasks[task].done_by = team
    world.count.done += 1
    world.count.news |= DONE
    _close(world, task, step)


@kernel
def _close(world: World, task: int, step: int) -> None:
    """Let a task be over, for everybody and for the tasks that come after it."""
    if world.tasks[task].is_open:
        world.tasks[task].is_open = False
        for cap in range(world.has.shape[1]):
            world.demand[cap] -= world.needs[task, cap] > 0
    for other in range(world.precedes.shape[0]):
        if world.precedes[task, other]:
            _await_one_less(world, other, step)


@kernel
def _await_one_less(world: World, task: int, step: int) -> None:
    """Let a task begin in the next step, if that was the last one that it came after."""
    world.tasks[task].awaits -= 1
    if world.tasks[task].awaits == 0:
        world.tasks[task].opens = max(world.tasks[task].opens, step)


@kernel
def _drop_assignments_to_over(world: World) -> None:
    for team in range(world.rules.robots):
        task = world.teams[team].task
        if task != NOBODY and not world.tasks[task].is_open:
            world.teams[team].task = NOBODY
            world.teams[team].is_detour = False


@kernel
def drop_assignments(world: World) -> None:
    """Free every team that is not serving its assignment: what everybody knows has changed."""
    for team in range(world.rules.robots):
        task = world.teams[team].task
        if task != NOBODY and world.tasks[task].server != team:
            world.teams[team].task = NOBODY
            world.teams[team].is_detour = False
