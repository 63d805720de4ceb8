"""Scenarios as the trees of their files (docs/reference/scenarios.md)."""

from __future__ import annotations

import math
from typing import Any

from teamformer.capabilities import Counts, exact
from teamformer.frame import Frame
from teamformer.grid import Place
from teamformer.mission.arrivals import without_arrivals
from teamformer.model import Arrivals, Robot, Scenario, Task, World
from teamformer.plane import Plane
from teamformer.roads import GROUND, Roads
from teamformer.scenarios.maps.road_tables import write_times
from teamformer.scenarios.trees.mission import VERSION
from teamformer.scenarios.trees.reader import INFINITE


def scenario_to_tree(scenario: Scenario) -> dict[str, Any]:
    """Return the tree of a scenario's file, with maps written out as rows."""
    world = scenario.world
    tree: dict[str, Any] = {
        "teamformer": VERSION,
        "name": scenario.name,
        "world": world_to_tree(world),
        "capabilities": list(scenario.capabilities),
        "robots": [_robot_to_tree(robot, world) for robot in scenario.robots],
        "tasks": [task_to_tree(task, world) for task in without_arrivals(scenario).tasks],
    }
    if scenario.teams:
        tree["teams"] = [[scenario.robots[r].name for r in team] for team in scenario.teams]
    tree |= {
        "sensing_radius": _radius_to_tree(scenario.sensing_radius),
        "join_radius": _radius_to_tree(scenario.join_radius),
        "forming_steps": scenario.forming_steps,
        "step_limit": scenario.step_limit,
        **_mission_rules_to_tree(scenario),
    }
    return tree


def _mission_rules_to_tree(scenario: Scenario) -> dict[str, Any]:
    """Return the rules of time and end that are not as in most missions."""
    tree: dict[str, Any] = {}
    if scenario.time != "steps":
        tree["time"] = scenario.time
    if scenario.ends is not None:
        ends = scenario.ends
        tree["ends"] = ends if isinstance(ends, str) else at_to_tree(ends, scenario.world)
    if scenario.forming:
        tree["forming"] = scenario.forming
    if scenario.cost is not None:
        tree["cost"] = dict(scenario.cost)
    if scenario.arrivals is not None:
        tree["arrivals"] = _arrivals_to_tree(scenario.arrivals)
    if scenario.finding_radius != 1:
        tree["finding_radius"] = _radius_to_tree(scenario.finding_radius)
    return tree


def _arrivals_to_tree(arrivals: Arrivals) -> dict[str, Any]:
    tree: dict[str, Any] = {"rate": arrivals.rate, "until": arrivals.until}
    tree |= {"needs": arrivals.most_needs} if arrivals.most_needs else {}
    tree |= {"duration": arrivals.duration} if arrivals.duration else {}
    return tree | ({"since": arrivals.since} if arrivals.since else {})


def world_to_tree(world: World) -> dict[str, Any]:
    """Return a world as it stands in a file that needs no other."""
    if isinstance(world, Plane):
        return {
            "plane": [world.width, world.height],
            "step": world.step,
            "arrival_radius": world.arrival_radius,
            "unit": world.unit,
        }
    if isinstance(world, Roads):
        tables = {mover: write_times(world, mover) for mover in world.times}
        return {"roads": tables[GROUND] if list(tables) == [GROUND] else tables}
    frame = {} if world.frame is None else {"frame": _frame_to_tree(world.frame)}
    if world.rows:
        return {"rows": list(world.rows), "y_axis": world.y_axis, **frame}
    turned = {} if world.y_axis == "up" else {"y_axis": world.y_axis}
    return {"grid": [world.width, world.height], **turned, **frame}


def _frame_to_tree(frame: Frame) -> dict[str, Any]:
    return {"cell": frame.cell, "origin": [frame.x, frame.y, frame.yaw]}


def at_to_tree(at: Place, world: World) -> list[float] | str:
    """Return where something is as it stands in a file."""
    return world.name_of(at) if isinstance(world, Roads) else list(at)


def _robot_to_tree(robot: Robot, world: World) -> dict[str, Any]:
    tree: dict[str, Any] = {
        "name": robot.name,
        "at": at_to_tree(robot.at, world),
        "can": counts_to_tree(robot.can),
    }
    if robot.speed != 1:
        tree["speed"] = robot.speed
    if robot.moves != GROUND:
        tree["moves"] = robot.moves
    tree |= absences_to_tree(robot)
    if robot.breaks is not None:
        repair = robot.breaks.repair
        tree["breaks"] = {"rate": robot.breaks.rate}
        tree["breaks"] |= {} if repair is None else {"repair": list(repair)}
    if robot.delays is not None:
        chance, seed = robot.delays.chance, robot.delays.seed
        tree["delays"] = chance if seed is None else {"chance": chance, "seed": seed}
    return tree


def absences_to_tree(robot: Robot) -> dict[str, Any]:
    """Return when a robot is lost and back: a step each, or lists where it is lost repeatedly."""
    times = {
        "lost": [away.lost for away in robot.absences],
        "back": [away.back for away in robot.absences if away.back is not None],
    }
    is_one = len(robot.absences) == 1
    return {key: steps[0] if is_one else steps for key, steps in times.items() if steps}


def task_to_tree(task: Task, world: World) -> dict[str, Any]:
    """Return a task as it stands in a file."""
    tree: dict[str, Any] = {
        "name": task.name,
        "at": at_to_tree(task.at, world),
        "needs": counts_to_tree(task.needs),
    }
    more = {
        "within": task.within,
        "may_need": dict(task.may_need),
        "duration": task.duration if task.lasts is None else list(task.lasts),
        "appears": task.appears,
        "cancelled": task.cancelled,
        "after": list(task.after),
        "between": [] if task.between is None else list(task.between),
        "to": [] if task.to is None else list(task.to),
        "unload": task.unload,
        "starts": {name: list(gap) for name, gap in task.starts.items()},
    }
    tree |= {key: value for key, value in more.items() if value}
    return tree | ({} if task.weight == 1 else {"weight": task.weight})


def counts_to_tree(counts: Counts) -> list[str] | dict[str, float]:
    """Return counts as they stand in a file."""
    if set(counts.values()) == {1}:
        return list(counts)
    return {name: exact(count) for name, count in counts.items()}


def _radius_to_tree(radius: float) -> float | str:
    return INFINITE if radius == math.inf else radius
