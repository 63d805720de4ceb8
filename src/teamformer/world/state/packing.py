"""Missions as arrays: a batch of worlds as they stand before the first step."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from teamformer.base.errors import MissionError
from teamformer.mission.checks.rules import FORESIGHTS, NEW_TASKS, rules_not_played
from teamformer.mission.checks.windows import window_opens
from teamformer.mission.model import Mission, Task, World
from teamformer.mission.parts.grid import Grid, Place
from teamformer.mission.parts.places import believed_place, possible_places
from teamformer.mission.parts.plane import DECIMALS, Plane
from teamformer.mission.parts.zones import all_rooms_of
from teamformer.mission.precedence import tasks_before
from teamformer.mission.truth import expected_needs
from teamformer.world.rules.chance import first_state
from teamformer.world.rules.constants import NEVER, NOBODY
from teamformer.world.rules.distances import UNREACHABLE, blocked_cells, distance_fields
from teamformer.world.state.arrays import (
    ANYWHERE,
    AREA,
    CELL,
    CHARGER,
    COUNT,
    INSIDE,
    LATEST,
    NAMED,
    ROBOT,
    RULES,
    SPOT,
    START,
    TASK,
    TEAM,
    UNLOADS,
    ZONE,
    Worlds,
)


def pack_worlds(
    missions: Sequence[Mission],
    truths: Sequence[Mission],
    is_coordinated: Sequence[bool],
    new_tasks: str,
    foresight: str,
) -> Worlds:
    """Lay missions out as they stand before the first step, padded to the largest of them.

    `truths` says what each of them really is, `is_coordinated` which of them have a coordinator.
    `new_tasks` is what the paper's order does with tasks that appear, `foresight` how needs that
    nobody knows are treated. Raises `MissionError` for missions whose rules are
    not those of the steps.
    """
    problems = [problem for mission in missions for problem in rules_not_played(mission)]
    if problems:
        raise MissionError(problems)
    worlds = _empty_worlds(missions, truths)
    worlds.rules["new_tasks"] = NEW_TASKS.index(new_tasks)
    worlds.rules["foresight"] = FORESIGHTS.index(foresight)
    for w, (mission, truth) in enumerate(zip(missions, truths, strict=True)):
        _pack_rules(worlds, w, mission)
        worlds.rules["is_coordinated"][w] = is_coordinated[w]
        _pack_robots(worlds, w, truth)
        _pack_tasks(worlds, w, mission, truth, foresight)
        if mission.charging:
            _pack_batteries(worlds, w, mission)
        _pack_zones(worlds, w, mission)
        if isinstance(mission.world, Grid) and mission.world.rows:
            places = [believed_place(mission.world, task) for task in mission.tasks]
            _pack_map(worlds, w, mission.world, places)
            if worlds.rules["has_loads"][w]:
                _pack_ways_of_loads(worlds, w, mission.world, mission.tasks)
    return worlds


def _empty_worlds(missions: Sequence[Mission], truths: Sequence[Mission]) -> Worlds:
    count = len(missions)
    robots = max(len(s.robots) for s in missions)
    tasks = max(len(s.tasks) for s in missions)
    caps = max(len(s.capabilities) for s in missions)
    cells = max(width * height for width, height, _ in map(_cells_of, missions))
    maps = [s.world for s in missions if isinstance(s.world, Grid) and s.world.rows]
    has_precedence = any(task.after for s in missions for task in s.tasks)
    precedes = (count, tasks, tasks) if has_precedence else (count, 0, 0)
    times = max(len(robot.absences) for truth in truths for robot in truth.robots)
    shifts = max(len(robot.shifts) for s in missions for robot in s.robots)
    chargers = max(len(s.chargers) if s.charging else 0 for s in missions)
    zones = max(len(mission.zones) for mission in missions)
    areas = max(sum(1 + len(zone.places) for zone in mission.zones) for mission in missions)
    hides_needs = any(task.may_need for s in missions for task in s.tasks)
    unsure = (count, tasks, caps) if hides_needs else (count, 0, 0)
    hides_places = any(task.within for s in missions for task in s.tasks)
    spots = (count, tasks, max(map(_most_places, missions))) if hides_places else (count, 0, 0)
    walls = (max((m.height for m in maps), default=0), max((m.width for m in maps), default=0))
    has_loads = any(task.to is not None for s in missions for task in s.tasks)
    fields = tasks * (2 if has_loads else 1) if walls[0] else 0
    worlds = Worlds(
        rules=np.zeros(count, dtype=RULES),
        count=np.zeros(count, dtype=COUNT),
        robots=np.zeros((count, robots), dtype=ROBOT),
        teams=np.zeros((count, robots), dtype=TEAM),
        tasks=np.zeros((count, tasks), dtype=TASK),
        cells=np.zeros((count, cells), dtype=CELL),
        spots=np.zeros(spots, dtype=SPOT),
        absences=np.full((count, robots, times if times > 1 else 0, 2), NEVER, dtype=np.int32),
        brings=np.zeros((count, robots, caps), dtype=np.int32),
        has=np.zeros((count, robots, caps), dtype=np.int32),
        needs=np.zeros((count, tasks, caps), dtype=np.int32),
        sure_needs=np.zeros(unsure, dtype=np.int32),
        true_needs=np.zeros(unsure, dtype=np.int32),
        expected_needs=np.zeros(unsure, dtype=np.int32),
        may_need=np.zeros(unsure, dtype=np.float32),
        precedes=np.zeros(precedes, dtype=np.bool_),
        demand=np.zeros((count, caps), dtype=np.int32),
        order=np.full((count, tasks), NOBODY, dtype=np.int32),
        blocked=np.ones((count, *walls), dtype=np.bool_),
        fields=np.full((count, fields, *walls), UNREACHABLE, dtype=np.int32),
        near=np.zeros((count, robots), dtype=np.int32),
        near_key=np.zeros((count, robots), dtype=np.int64),
        room=np.zeros((count, caps), dtype=np.int32),
        here=np.zeros((count, tasks), dtype=np.int32),
        shifts=np.full((count, robots, shifts, 2), NEVER, dtype=np.int32),
        chargers=np.zeros((count, chargers), dtype=CHARGER),
        wanted=np.zeros((count, robots, tasks) if chargers else (count, 0, 0)),
        to_charger=np.full((count, chargers, *walls), UNREACHABLE, dtype=np.int32),
        zones=np.zeros((count, zones), dtype=ZONE),
        inside=np.zeros((count, zones, tasks), dtype=np.uint8),
        areas=np.zeros((count, areas), dtype=AREA),
    )
    _say_nothing_yet(worlds)
    return worlds


def _say_nothing_yet(worlds: Worlds) -> None:
    """Write where there is nobody, and what never was, into worlds that are all zeros."""
    worlds.robots["team"] = NOBODY
    worlds.robots["lost"] = worlds.robots["back"] = worlds.robots["over"] = NEVER
    worlds.robots["queued"] = NOBODY
    worlds.teams["task"] = worlds.teams["charger"] = worlds.teams["charges_for"] = NOBODY
    worlds.cells["first_team"] = worlds.cells["first_task"] = NOBODY
    worlds.tasks["appears"] = worlds.tasks["cancelled"] = NEVER
    for field in ("next_here", "server", "done_at", "done_by", "missed_at"):
        worlds.tasks[field] = NOBODY
    for field in ("shown_at", "moved_at", "found_at", "taken_at", "left_at"):
        worlds.tasks[field] = NOBODY
    worlds.robots["next"] = NOBODY
    worlds.tasks["is_planned"] = True
    worlds.count["news"] = START


def _pack_rules(worlds: Worlds, w: int, mission: Mission) -> None:
    width, height, cells_per_length = _cells_of(mission)
    plane = mission.world if isinstance(mission.world, Plane) else None
    here = plane.arrival_radius if plane else 0.0
    rules = {
        "robots": len(mission.robots),
        "tasks": len(mission.tasks),
        "width": width,
        "height": height,
        "forming_steps": mission.forming_steps,
        "step_limit": mission.step_limit,
        "hides_needs": any(task.may_need for task in mission.tasks),
        "has_delays": any(robot.delays or robot.shifts for robot in mission.robots),
        "has_shifts": any(robot.shifts for robot in mission.robots),
        "has_batteries": mission.charging is not None,
        "chargers": len(mission.chargers) if mission.charging else 0,
        "hides_places": any(task.within for task in mission.tasks),
        "has_loads": any(task.to is not None for task in mission.tasks),
        "has_walls": bool(mission.world.rows),
        "is_plane": plane is not None,
        "sensing_radius": max(mission.sensing_radius, here),
        "join_radius": max(mission.join_radius, here),
        "finding_radius": max(mission.finding_radius, here),
        "arrival_radius": here,
        "unit": plane.unit if plane else 1.0,
        "cells_per_length": cells_per_length,
        "until": NEVER if mission.until is None else min(int(mission.until), LATEST),
    }
    for name, value in rules.items():
        worlds.rules[name][w] = value
    worlds.rules["start_x"][w], worlds.rules["start_y"][w] = _centroid(mission)


def _cells_of(mission: Mission) -> tuple[int, int, float]:
    """Return how many cells across and up, and how many a length; on a plane, to look around.

    There a cell is wider than any finite radius, so that what is near lies in the cells around,
    and there are no more of them than a few for each robot and task.
    """
    world = mission.world
    if isinstance(world, Grid):
        return world.width, world.height, 1.0
    radii = (mission.sensing_radius, mission.join_radius, world.arrival_radius)
    widest = max((radius for radius in radii if radius < math.inf), default=0.0)
    most = 4 * (len(mission.robots) + len(mission.tasks))
    area, longest = world.width * world.height, max(world.width, world.height)
    side = max(1.001 * widest, math.sqrt(area / most), longest / most)
    return int(world.width / side) + 1, int(world.height / side) + 1, 1 / side


def _centroid(mission: Mission) -> Place:
    """Return the place at the robots' centroid; where that is blocked, the nearest robot's."""
    places = [robot.at for robot in mission.robots]
    x = sum(x for x, _ in places) / len(places)
    y = sum(y for _, y in places) / len(places)
    if isinstance(mission.world, Plane):
        return round(x, DECIMALS), round(y, DECIMALS)
    cell = (int(x + 0.5), int(y + 0.5))
    if mission.world.is_free(cell):
        return cell
    return min(places, key=lambda at: (at[0] - x) ** 2 + (at[1] - y) ** 2)


def _pack_robots(worlds: Worlds, w: int, mission: Mission) -> None:
    column = {name: c for c, name in enumerate(mission.capabilities)}
    for r, robot in enumerate(mission.robots):
        record = worlds.robots[w, r]
        record["pace"] = mission.world.pace(robot.speed)
        times = [
            (away.lost, NEVER if away.back is None else min(away.back, LATEST))
            for away in robot.absences
        ]
        record["lost"], record["back"] = times[0] if times else (NEVER, NEVER)
        if worlds.absences.shape[2]:
            worlds.absences[w, r, : len(times)] = np.reshape(times, (-1, 2))
        if worlds.shifts.shape[2]:
            shifts = robot.shifts or [(0, NEVER)]
            worlds.shifts[w, r, : len(shifts)] = np.minimum(shifts, NEVER)
            record["every"], record["over"] = robot.every, min(robot.rota.over, NEVER)
        if robot.delays is not None:
            record["delay"] = robot.delays.chance
            record["luck"] = first_state(robot.delays.seed or 0)
        flies_over = robot.flies and mission.world.rows
        record["region"] = ANYWHERE if flies_over else mission.world.region(robot.at)
        for name, count in mission.in_units(robot.can).items():
            worlds.brings[w, r, column[name]] = count
    for members in mission.starting_teams:
        slot, robots = members[0], list(members)
        team = worlds.teams[w, slot]
        team["x"], team["y"] = mission.robots[slot].at
        team["size"] = len(members)
        team["pace"] = worlds.robots[w, robots]["pace"].min()
        team["region"] = worlds.robots[w, robots]["region"].max()
        worlds.robots["team"][w, robots] = slot
        worlds.has[w, slot] = worlds.brings[w, robots].sum(axis=0)


def _pack_tasks(worlds: Worlds, w: int, mission: Mission, truth: Mission, foresight: str) -> None:
    cap_of = {name: c for c, name in enumerate(mission.capabilities)}
    for later, before in tasks_before(mission.tasks).items():
        worlds.precedes[w, before, later] = True
    width, height, cells_per_length = _cells_of(mission)
    for k in reversed(range(len(mission.tasks))):  # so that each cell's chain is in task order
        task, record = mission.tasks[k], worlds.tasks[w, k]
        place = believed_place(mission.world, task)
        record["x"], record["y"] = place
        record["duration"], record["longest"] = task.duration, task.longest
        record["takes"], record["hides_needs"] = truth.tasks[k].duration, bool(task.may_need)
        record["appears"], record["awaits"] = task.appears, len(task.after)
        record["opens"] = window_opens(task)
        record["is_optional"] = task.optional
        if task.cancelled is not None:
            record["cancelled"] = min(task.cancelled, LATEST)
        if task.to is not None:
            record["is_load"], record["unload"] = True, task.unload
            record["to_x"], record["to_y"] = task.to
        record["region"] = mission.world.region(place)
        record["is_open"] = task.appears == 0
        column, row = (int(along * cells_per_length) for along in place)
        cell = worlds.cells[w, min(row, height - 1) * width + min(column, width - 1)]
        record["next_here"], cell["first_task"] = cell["first_task"], k
        if task.within:
            _pack_places(worlds, w, k, task, mission.world, truth.tasks[k].at)
        believed = expected_needs(task, foresight)
        for name, count in mission.in_units(believed).items():
            worlds.needs[w, k, cap_of[name]] = count
        if len(worlds.true_needs[w]):
            worlds.expected_needs[w, k] = worlds.needs[w, k]
            for name, count in mission.in_units(task.needs).items():
                worlds.sure_needs[w, k, cap_of[name]] = count
            for name, count in mission.in_units(truth.tasks[k].needs).items():
                worlds.true_needs[w, k, cap_of[name]] = count
            for name, probability in task.may_need.items():
                worlds.may_need[w, k, cap_of[name]] = probability
    is_known = worlds.tasks["is_open"][w]
    worlds.demand[w] = (worlds.needs[w, is_known] > 0).sum(axis=0)
    may_begin = (worlds.tasks["opens"][w] == 0) & (worlds.tasks["awaits"][w] == 0)
    is_shared_out = is_known & (worlds.rules["is_coordinated"][w] | may_begin)
    order = np.flatnonzero(is_shared_out)
    worlds.order[w, : len(order)] = order
    worlds.count["open"][w] = worlds.count["arrived"][w] = len(order)


def _pack_batteries(worlds: Worlds, w: int, mission: Mission) -> None:
    charging, places = mission.charging, [charger.at for charger in mission.chargers]
    assert charging is not None, "somebody has a battery"
    for r, robot in enumerate(mission.robots):
        record, battery = worlds.robots[w, r], robot.battery
        worlds.wanted[w, r, : len(mission.tasks)] = charging.wanted(r)
        if battery is not None:
            record["lasts"], record["left"] = battery.lasts, battery.starts * battery.lasts
            record["filled"] = battery.lasts / battery.fills if battery.fills else battery.lasts
            record["serving"], record["waiting"] = battery.serving, battery.waiting
    for c, charger in enumerate(mission.chargers):
        record = worlds.chargers[w, c]
        record["room"], (record["x"], record["y"]) = charger.room, charger.at
    if isinstance(mission.world, Grid) and mission.world.rows:
        fields = worlds.to_charger[w, : len(places), : mission.world.height, : mission.world.width]
        fields[:] = distance_fields(mission.world, places)


def _pack_zones(worlds: Worlds, w: int, mission: Mission) -> None:
    names, areas = [task.name for task in mission.tasks], []
    for zone, tasks, room, loads in all_rooms_of(mission):
        said = mission.zones[zone]
        worlds.zones["room"][w, zone] = room
        worlds.inside[w, zone, sorted(tasks)] |= INSIDE
        worlds.inside[w, zone, sorted(loads)] |= UNLOADS
        worlds.inside[w, zone, [names.index(name) for name in said.tasks]] |= NAMED
        areas += [(zone, *said.area[0], *said.area[1])] if said.area else []
        areas += [(zone, *place, *place) for place in said.places]
    worlds.areas["zone"][w] = NOBODY
    worlds.areas[w, : len(areas)] = areas
    worlds.tasks["is_in_zone"][w] = (worlds.inside[w] & INSIDE).any(axis=0)
    worlds.tasks["is_brought_to_zone"][w] = (worlds.inside[w] & UNLOADS).any(axis=0)
    worlds.tasks["came_at"][w] = NOBODY


def _pack_places(worlds: Worlds, w: int, k: int, task: Task, world: World, at: Place) -> None:
    """Write down where a task may be, where it is believed to be, and where it is: at `at`."""
    places, record = possible_places(world, task.at, task.within), worlds.tasks[w, k]
    record["hides_place"], record["within"] = True, task.within
    record["reach"] = max(math.dist(places[0], place) for place in places)
    record["lies_in"], record["believed_in"] = places.index(at), 0
    for number, place in enumerate(places):
        worlds.spots[w, k, number] = (*place, True)


def _most_places(mission: Mission) -> int:
    """Return in how many places a task of a mission may be at most."""
    return max(len(possible_places(mission.world, t.at, t.within)) for t in mission.tasks)


def _pack_map(worlds: Worlds, w: int, grid: Grid, places: Sequence[Place]) -> None:
    worlds.blocked[w, : grid.height, : grid.width] = blocked_cells(grid)
    worlds.fields[w, : len(places), : grid.height, : grid.width] = distance_fields(grid, places)


def _pack_ways_of_loads(worlds: Worlds, w: int, grid: Grid, tasks: Sequence[Task]) -> None:
    """Write down how far it is from everywhere to where each load is brought."""
    for number, task in enumerate(tasks):
        if task.to is not None:
            row = worlds.tasks.shape[1] + number
            field = worlds.fields[w, row, : grid.height, : grid.width]
            field[:] = distance_fields(grid, [task.to])[0]
