"""Phase 7: services go on, break off, begin and end; what is missed; and when all is over."""

from __future__ import annotations

from teamformer.mission.checks.windows import window_opens
from teamformer.mission.parts.capabilities import covers, total
from teamformer.mission.parts.reach import can_reach
from teamformer.mission.parts.zones import AtWork
from teamformer.world.reference.carrying import carry, steps_to_go, take_up
from teamformer.world.reference.charging import has_enough
from teamformer.world.reference.state import PlainTeam, PlainWorld


def complete_tasks(world: PlainWorld) -> None:
    """Let services go on; then teams, in slot order, begin with what they stand at and can do."""
    for slot, team in world.in_slot_order():
        for task in sorted(team.serving):
            _serve(world, slot, team, task)
    for slot, team in world.in_slot_order():
        if team.charger is not None or _is_with_load(world, slot, team):
            continue
        for task in world.tasks_at(team.at):
            is_bound = world.mission.tasks[task].to is not None or task in world.in_zones
            is_ready = not is_bound and _is_ready(world, team, task)
            is_ready = is_ready and (task == team.task or has_enough(world, team, task))
            if is_ready and _fits(world, team, task):
                _begin(world, slot, team, task)
    _enter_zones(world)
    world.happened.done = dict(sorted(world.happened.done.items()))
    for team in world.teams.values() if world.happened.done else ():
        if team.task is not None and team.task not in world.open:
            team.task, team.is_detour = None, False


def _enter_zones(world: PlainWorld) -> None:
    """Let tasks in zones begin in the order, where there is room for those before them, too.

    Each is begun by a team that is assigned to it, the lowest of those that can. What goes on takes
    room, and so does what is still to begin before by the plan. Loads are unloaded before.
    """
    work = AtWork(world.served - world.carried, world.unloading & world.served)
    taken = {room.zone: len(room.inside(work)) for room in world.rooms}
    _unload_in_zones(world, taken)
    for task in (k for k in world.order if k in world.in_zones and k in world.open - world.served):
        rooms = [room for room in world.rooms if task in room.tasks]
        able = [
            (slot, team)
            for slot, team in world.in_slot_order()
            if team.task == task and team.charger is None and world.is_same(team.at, world.at[task])
            if _is_ready(world, team, task) and _fits(world, team, task)
            if not (team.serving and world.mission.tasks[task].to)
        ]
        if able and all(taken[room.zone] < room.room for room in rooms):
            _begin(world, *able[0], task)
        is_waiting = task in world.open and task in world.awaited
        if task in world.served or is_waiting:
            taken |= {room.zone: taken[room.zone] + 1 for room in rooms}


def _unload_in_zones(world: PlainWorld, taken: dict[int, int]) -> None:
    """Let loads be unloaded that are where they are brought to: who came first is first.

    Who goes on waiting takes room, too: nobody begins there before.
    """
    queue = {(came, task) for task, came in world.came.items() if task in world.served}
    for _, task in sorted(queue):
        rooms = [room for room in world.rooms if task in room.loads]
        slot, team = next((s, t) for s, t in world.in_slot_order() if task in t.serving)
        if all(taken[room.zone] < room.room for room in rooms):
            del world.came[task]
            world.unloading.add(task)
            team.serving[task] -= 1
            if team.serving[task] == 0:
                _finish(world, slot, team, task)
        if task in world.served:
            taken |= {room.zone: taken[room.zone] + 1 for room in rooms}


def _serve(world: PlainWorld, slot: int, team: PlainTeam, task: int) -> None:
    if task in world.carried:
        if carry(world, team, task):
            _finish(world, slot, team, task)
        return
    team.serving[task] -= 1
    is_able = world.covers(team.has, task) and world.is_in_shift(
        team.robots, world.begun_at[task], world.steps + 1
    )
    if not (is_able and world.is_same(team.at, world.at[task])):
        del team.serving[task]
        world.served.discard(task)
        world.happened.any_broken_off = True
    elif team.serving[task] > 0:
        _expect_end(world, team, task)
    else:
        _end_work_there(world, slot, team, task)


def _end_work_there(world: PlainWorld, slot: int, team: PlainTeam, task: int) -> None:
    """Let a task be done, or a load be taken up, once the steps are over that it takes."""
    if world.mission.tasks[task].to is None or take_up(world, slot, team, task):
        _finish(world, slot, team, task)


def _is_with_load(world: PlainWorld, slot: int, team: PlainTeam) -> bool:
    """Let a team begin with the load that it has come for; say whether it is at one.

    It then begins nothing else, and nobody takes up a load on the way to something else.
    """
    task = team.task
    if task is None or world.mission.tasks[task].to is None:
        return False
    is_here = not team.serving and world.is_same(team.at, world.at[task])
    if is_here and _is_ready(world, team, task):
        if not _carries_in_time(world, team, task):
            _miss(world, task, world.steps + 1)
            return False
        if task not in world.in_zones and _fits(world, team, task):
            _begin(world, slot, team, task)
            return True
    return task in team.serving


def _carries_in_time(world: PlainWorld, team: PlainTeam, task: int) -> bool:
    """Say whether a team that begins with a load now is done with it by the end of the mission."""
    to = world.mission.tasks[task].to
    assert to is not None
    return _ends_in_time(world, task, world.steps + 1 + steps_to_go(world, team, to))


def _ends_in_time(world: PlainWorld, task: int, begins: int) -> bool:
    """Say whether a task that begins in a step, without a way, ends before the mission does."""
    wanted, until = world.mission.tasks[task], world.mission.until
    return until is None or begins + wanted.duration + wanted.unload <= until


def miss_tasks(world: PlainWorld) -> None:
    """At the end of a step, let tasks be missed that nobody can end by the end of the mission."""
    step, until = world.steps + 1, world.mission.until
    if until is None:
        return
    for task, wanted in enumerate(world.mission.tasks):
        if world.over_in(task) is not None:
            continue
        is_waiting = task in world.open and task not in world.served
        begins = max(step, window_opens(wanted)) + 1
        if step >= until or (is_waiting and not _ends_in_time(world, task, begins)):
            _miss(world, task, step)
    world.happened.missed.sort()


def _miss(world: PlainWorld, task: int, step: int) -> None:
    world.missed[task] = step
    world.happened.missed.append(task)
    world.drop(task)


def may_give_up(world: PlainWorld) -> bool:
    """Say whether all that is left is optional and known, and nobody does or comes to do anything.

    A mission lasts a step at least.
    """
    tasks = world.truth.tasks
    left = [task for task in range(len(tasks)) if world.over_in(task) is None]
    is_quiet = not world.served and world.open.isdisjoint(world.next)
    is_due = any(world.is_due(robot) for robot in world.lost_at)
    return (
        world.is_coordinated
        and world.mission.until is not None
        and world.steps > 0
        and is_quiet
        and not is_due
        and all(tasks[task].optional and task in world.open for task in left)
    )


def give_up(world: PlainWorld) -> None:
    """Let all that is left be missed, after a step; nothing else changes."""
    for task in sorted(world.open):
        world.missed[task] = world.steps
        world.happened.missed.append(task)
    world.happened.missed.sort()
    world.open.clear()


def _is_ready(world: PlainWorld, team: PlainTeam, task: int) -> bool:
    """Say whether a team can do a task, which may begin and which nobody does."""
    is_free = task in world.open and task in world.may_begin and task not in world.served
    is_free = is_free and _ends_in_time(world, task, world.steps + 1)
    return is_free and task not in world.let_go and world.covers(team.has, task)


def _fits(world: PlainWorld, team: PlainTeam, task: int) -> bool:
    """Say whether a task that begins in this step fits, as it is believed, into shifts of all."""
    if not world.rotas:
        return True
    wanted, now = world.mission.tasks[task], world.steps + 1
    carried = 0 if wanted.to is None else steps_to_go(world, team, wanted.to)
    takes = int(wanted.duration + wanted.unload) + carried
    return world.is_in_shift(team.robots, now, now + takes)


def _begin(world: PlainWorld, slot: int, team: PlainTeam, task: int) -> None:
    duration, is_load = int(world.truth.tasks[task].duration), world.mission.tasks[task].to
    if duration or is_load is not None:
        world.served.add(task)
        world.happened.begun.append(task)
        world.begun_at[task] = world.steps + 1
        team.serving[task] = duration
        team.credit = 0.0
        world.due[task] = max(1, int(world.mission.tasks[task].duration))
    if not duration:
        _end_work_there(world, slot, team, task)


def _expect_end(world: PlainWorld, team: PlainTeam, task: int) -> None:
    """Expect a service that ought to be over to end amid what is left of the longest."""
    served = int(world.truth.tasks[task].duration) - team.serving[task]
    if served >= world.due[task]:
        world.due[task] = (served + 1 + int(world.mission.tasks[task].longest) + 1) // 2
        world.happened.any_overdue = True


def _finish(world: PlainWorld, slot: int, team: PlainTeam, task: int) -> None:
    team.serving.pop(task, None)
    for tasks in (world.open, world.carried, world.served, world.unloading):
        tasks.discard(task)
    world.done[task] = world.steps + 1
    world.happened.done[task] = slot


def release_tasks(world: PlainWorld) -> None:
    """Make known what appears now, and write down what may begin from the next step on."""
    for task, wanted in enumerate(world.mission.tasks):
        is_unknown = task not in world.known and world.over_in(task) is None
        if is_unknown and world.steps >= wanted.appears:
            world.known.add(task)
            world.open.add(task)
            world.happened.known.append(task)
    for task in sorted(world.open - world.may_begin):
        if _has_opened(world, task):
            world.may_begin.add(task)
            world.happened.opened.append(task)


def _has_opened(world: PlainWorld, task: int) -> bool:
    """Say whether the window of a task has begun, and all that it comes after is over."""
    between = world.mission.tasks[task].between
    has_begun = between is None or world.steps >= between[0]
    return has_begun and all(world.over_in(k) is not None for k in world.before.get(task, ()))


def drop_assignments(world: PlainWorld) -> None:
    """Free every team that is not serving its assignment: what everybody knows has changed."""
    for team in world.teams.values():
        if team.task not in team.serving:
            team.task, team.is_detour = None, False


def blocked_tasks(world: PlainWorld) -> list[str]:
    """Name the undone tasks that the robots left and due back can never do.

    A robot whose last shift is over is not left.
    A task that is to be called off is none of them.
    """
    mission = world.truth
    robots = [
        robot
        for number, (robot, slot) in enumerate(zip(mission.robots, world.slot_of, strict=True))
        if (slot is not None or world.is_due(number)) and robot.rota.over > world.steps
    ]
    return [
        task.name
        for number, task in enumerate(mission.tasks)
        if world.over_in(number) is None
        and task.cancelled is None
        and not task.optional
        and not covers(
            total(r.can for r in robots if can_reach(mission.world, r, task.at)), task.needs
        )
    ]


def status_of(world: PlainWorld) -> str:
    """Say how a mission stands after a step: `running`, or why no more step is made."""
    happened = world.happened
    tasks = world.truth.tasks
    if all(world.over_in(task) is not None for task in range(len(tasks))):
        has_failed = any(not tasks[task].optional for task in world.missed)
        return "too late" if has_failed else "completed"
    is_news = bool(happened.lost or happened.back or happened.cancelled or happened.is_elsewhere)
    is_news |= any(rota.over == world.steps for rota in world.rotas)
    if is_news and blocked_tasks(world):
        return "infeasible"
    return "step limit" if world.steps >= world.mission.step_limit else "running"
