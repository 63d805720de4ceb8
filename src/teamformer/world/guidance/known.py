"""What everybody knows of a world, as coordinators are told it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from teamformer.base.array_types import Array
from teamformer.mission.coordination import NEWS, Known
from teamformer.mission.model import Mission, as_believed
from teamformer.mission.parts.grid import Grid
from teamformer.mission.truth import believed_mission
from teamformer.world.rules.constants import NOBODY
from teamformer.world.state.arrays import Worlds


def known_of(worlds: Worlds, w: int, mission: Mission, news: int) -> Known:
    """Return what everybody knows of world `w`; `news` holds what has happened, a bit for each."""
    robots, tasks, teams = worlds.robots[w], worlds.tasks[w], worlds.teams[w]
    step = int(worlds.count["steps"][w])
    free_at = np.full(len(teams), step)  # (slots,)
    under_way: list[tuple[int, int]] = []
    loading: dict[int, float] = {}
    x, y = teams["x"].copy(), teams["y"].copy()  # where teams are once they are free
    for task in np.flatnonzero(tasks["server"] != NOBODY).tolist():
        server = int(tasks["server"][task])
        rest = tasks["ahead"][task]
        if not tasks["is_carried"][task]:
            rest += tasks["expected"][task] - tasks["served"][task]
        until = step + int(rest)
        free_at[server] = max(int(free_at[server]), until)
        under_way.append((task, until))
        if tasks["is_load"][task] and not tasks["is_carried"][task]:
            loading[task] = until - int(tasks["ahead"][task])
        if tasks["is_load"][task]:
            x[server], y[server] = tasks["to_x"][task], tasks["to_y"][task]
    slots = robots["team"][: len(mission.robots)]
    along = int if isinstance(mission.world, Grid) else float
    members = {slot: np.flatnonzero(slots == slot) for slot in np.unique(slots[slots != NOBODY])}
    return Known(
        mission=_without_what_is_over(_believed(worlds, w, mission), tasks, step),
        now=step,
        open_tasks=tuple(np.flatnonzero(tasks["is_open"] & (tasks["server"] == NOBODY)).tolist()),
        places=tuple((along(x[slot]), along(y[slot])) for slot in slots),
        teams=tuple(tuple(members[slot].tolist()) for slot in sorted(members)),
        free_at=tuple(free_at[slots].tolist()),
        under_way=tuple(under_way),
        unseen_needs=frozenset(np.flatnonzero(tasks["hides_needs"]).tolist()),
        unseen_places=frozenset(np.flatnonzero(tasks["hides_place"]).tolist()),
        news=words_of(news),
        left=_left(robots, len(mission.robots)),
        loading=loading,
        unloading=frozenset(
            np.flatnonzero(tasks["is_unloading"] | (tasks["came_at"] != NOBODY)).tolist()
        ),
    )


def _left(robots: Array, count: int) -> tuple[float, ...]:
    """Return what the first so many robots have left; infinite for who has no battery."""
    left = np.where(robots["lasts"] > 0, robots["left"], np.inf)  # (robots,)
    return tuple(left[:count].tolist())


def words_of(news: int) -> tuple[str, ...]:
    """Return the words for news that is a bit each, in the order of `NEWS`."""
    return tuple(word for bit, word in enumerate(NEWS) if news & 1 << bit)


def _believed(worlds: Worlds, w: int, mission: Mission) -> Mission:
    """Return a mission with what everybody believes that its tasks need, and where they are."""
    caps, tasks = mission.capabilities, range(len(mission.tasks))
    needs: dict[int, dict[str, float]] = {}
    if worlds.rules["hides_needs"][w]:
        for task, counts in zip(tasks, worlds.needs[w].tolist(), strict=False):
            believed = {c: n for c, n in zip(caps, counts, strict=False) if n}
            needs[task] = mission.out_of_units(believed)
    along = int if isinstance(mission.world, Grid) else float
    at = worlds.tasks[["x", "y"]][w]
    unsure = [task for task in tasks if mission.tasks[task].within or _is_left(worlds, w, task)]
    places = {task: (along(at["x"][task]), along(at["y"][task])) for task in unsure}
    lies = {task: places[task] for task in unsure if _is_left(worlds, w, task)}
    return believed_mission(mission, needs, places, lies)


def _without_what_is_over(mission: Mission, tasks: Array, step: int) -> Mission:
    """Return a mission whose tasks are `after` those only that are not over; (tasks,) records."""
    if not any(task.after for task in mission.tasks):
        return mission
    is_over = (tasks["done_at"] != NOBODY) | (tasks["missed_at"] != NOBODY)
    is_over |= tasks["cancelled"] <= step
    over = {task.name for task, gone in zip(mission.tasks, is_over.tolist(), strict=False) if gone}
    left = (tuple(name for name in task.after if name not in over) for task in mission.tasks)
    shorter = zip(mission.tasks, left, strict=True)
    tasks_left = (
        task if names == task.after else replace(task, after=names) for task, names in shorter
    )
    return as_believed(mission, tasks=tuple(tasks_left))


def _is_left(worlds: Worlds, w: int, task: int) -> bool:
    """Say whether a load lies where it was set down on its way."""
    record = worlds.tasks[w, task]
    return bool(record["left_at"] != NOBODY and record["server"] == NOBODY and record["is_open"])
