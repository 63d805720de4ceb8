"""DCMRTA's instances (ICRA 2024), as written for CTAS-D: like robots, tasks that need several.

A folder holds `graph.yaml` (ways between the nodes, durations at them), `task_param.yaml` (how
many robots each task needs), `vehicle_param.yaml` and `planner_param.yaml` (how many there are).
The depot is the node after the tasks, and the one after it is where robots end: the same place,
to which no edge leads but from tasks.
Only distances are given; the places are worked out from them (classical scaling, Torgerson 1952).
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from teamformer.base.array_types import Floats
from teamformer.base.errors import TeamformerError
from teamformer.files.imports.trees import HINT, TreePart, read_yaml, refuse_detours
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.layout import places_of
from teamformer.mission.parts.plane import Plane

START, END, DISTANCE, TIME = 0, 1, 3, 5
"""Where an edge of the graph names its nodes, its length and the time that it takes."""

EXACT = 1e-6
"""How far a way between two places may be from what the file says."""


def read(path: Path) -> list[Mission]:
    """Return the mission of an instance, a folder."""
    if not path.is_dir():
        raise TeamformerError(f"{path}: this is no folder", "name the folder with graph.yaml in it")
    graph = read_yaml(path / "graph.yaml")["vehicle0"]
    needs = _needs(read_yaml(path / "task_param.yaml"))
    robots = _robots(path)
    ways, speed = _ways(graph, len(needs))
    places = places_of(ways)
    _refuse_crooked(graph, ways, places)
    places -= places.min(axis=0)
    spot = [(float(x), float(y)) for x, y in places]
    return [
        Mission(
            name=path.name,
            world=Plane(*(max(1.0, float(side)) for side in places.max(axis=0))),
            capabilities=("robot",),
            robots=tuple(Robot(f"r{n}", spot[-1], {"robot": 1}, speed) for n in range(robots)),
            tasks=tuple(
                Task(f"t{n}", spot[n], {"robot": need}, graph[f"node{n}"].number(0))
                for n, need in enumerate(needs)
            ),
            time="continuous",
            ends="home",
        )
    ]


def _needs(tree: TreePart) -> list[int]:
    """Return how many robots each task needs."""
    needs = []
    for number in range(len(tree.parts())):
        requirement = tree[f"task{number}"]["and0"]["or0"]
        if requirement["capId"].whole(0) != 0:
            requirement["capId"].refuse("is another capability; this format has only one")
        needs.append(requirement["capReq"].whole(1))
    return needs


def _robots(path: Path) -> int:
    """Return how many robots there are, all of one kind."""
    kinds = read_yaml(path / "vehicle_param.yaml")
    planner = read_yaml(path / "planner_param.yaml")
    if len(kinds.parts()) != 1:
        kinds.refuse(f"holds {len(kinds.parts())} kinds of robots; only one is known here")
    capacity = kinds["vehicle0"]["capVector"]
    if capacity.numbers() != [1.0]:
        capacity.refuse(f"is {capacity.value}; here should be [1.0]")
    return planner["vehNumPerType"][0].whole(1)


def _ways(graph: TreePart, tasks: int) -> tuple[Floats, float]:
    """Return the distances between the tasks and the depot, the last, and the robots' speed."""
    ways = np.full((tasks + 1, tasks + 1), np.nan)
    np.fill_diagonal(ways, 0.0)
    speeds = []
    for name, edge in graph.parts():
        if not name.startswith("edge"):
            continue
        begin, end = edge[START].whole(0), edge[END].whole(0)
        if begin > tasks or end > tasks + 1:
            edge.refuse(f"goes from {begin} to {end}, but there are {tasks} tasks and two depots")
        end = min(end, tasks)  # robots end where they start
        ways[begin, end] = edge[DISTANCE].number(0)
        if ways[begin, end] > EXACT:
            speeds.append(ways[begin, end] / edge[TIME].number(1e-9))
    missing = np.argwhere(np.isnan(ways))
    if len(missing):
        begin, end = missing[0]
        graph.refuse(f"is not square: no edge goes from {begin} to {end}", HINT)
    speed = float(np.median(speeds)) if speeds else 1.0
    if speeds and max(speeds) - min(speeds) > EXACT * speed:
        graph.refuse(f"has speeds from {min(speeds):g} to {max(speeds):g}; here should be one")
    return ways, round(speed, 9)


def _refuse_crooked(graph: TreePart, ways: Floats, places: Floats) -> None:
    """Refuse ways that are not straight ones between points of a plane."""
    names = [*(f"node {n}" for n in range(len(ways) - 1)), "the depot"]
    refuse_detours(graph, names, ways, EXACT)
    straight = np.linalg.norm(places[:, None] - places[None], axis=2)
    off = np.abs(straight - ways)
    if off.max() > EXACT:
        i, j = np.unravel_index(np.argmax(off), off.shape)
        graph.refuse(
            f"does not hold straight ways in a plane: from {names[i]} to {names[j]} it is "
            f"{ways[i, j]:g}, and with all others as they are {straight[i, j]:g}"
        )
