"""Navigation graphs of Open-RMF: a file of `nav_graphs`, as its traffic editor writes them.

Each level has vertices `[x, y, {name: ...}]` in metres, and lanes `[from, to, {speed_limit: ...}]`
between them. Vertices in one lift are joined. Robots start at chargers, or at parking spots where
there is no charger; dispensers and ingestors are tasks.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import permutations
from pathlib import Path

from teamformer.files.imports.site import CARRY, Lane, Site, roads_of, seconds_of, told_apart
from teamformer.files.imports.trees import TreePart, read_yaml
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.roads import GROUND

IN_A_LIFT = 20.0
"""Seconds from one level to another; the file does not say how long lifts take."""

STARTS = ("is_charger", "is_parking_spot")
"""Robots start at the vertices that have the first of these, if any has it."""

JOBS = {"pickup_dispenser": "pick up at", "dropoff_ingestor": "drop off at"}
"""What makes a vertex a task, and what the task is called."""


@dataclass(frozen=True)
class Vertex:
    """Where a vertex is, and the part of the file that says what it is."""

    level: str
    x: float
    y: float
    said: TreePart

    def says(self, key: str) -> bool:
        """Say whether something is so of it."""
        return self.said.value.get(key) is True

    def text(self, key: str) -> str:
        """Return what it is called; nothing where it is not said."""
        return self.said[key].text() if self.said.value.get(key) else ""

    @property
    def lift(self) -> str:
        """Return the lift that it is in; older files call it the cabin."""
        return self.text("lift") or self.text("lift_cabin")


def read(path: Path) -> list[Mission | Site]:
    """Return the site of a navigation graph; a mission if it has robots and tasks."""
    tree = read_yaml(path)
    vertices, lanes = list[Vertex](), list[Lane]()
    for level, part in tree["levels"].parts():
        first = len(vertices)
        vertices += [_vertex(level, one) for _, one in part["vertices"].parts()]
        lanes += _lanes(part["lanes"], vertices, first)
    world = roads_of(_names(vertices), {GROUND: [*lanes, *_lifts(vertices)]})
    places = [world.at(name) for name in world.places]
    name = tree["building_name"].text() if tree.value.get("building_name") else path.stem
    robots, tasks = tuple(_robots(vertices, places)), tuple(_tasks(vertices, places, world.places))
    return [Site(name, world, robots, tasks).complete()]


def _vertex(level: str, part: TreePart) -> Vertex:
    said = part[2]
    if not isinstance(said.value, dict):
        said.refuse("is no mapping; here should be what the vertex is, such as {name: dock}")
    return Vertex(level, part[0].number(), part[1].number(), said)


def _names(vertices: Sequence[Vertex]) -> list[str]:
    """Return what places are called: by their names, where these do not tell them apart by level
    too, and those without a name by number."""
    names = [vertex.text("name") for vertex in vertices]
    with_level = [
        f"{name} {vertex.level}" if name and names.count(name) > 1 else name
        for name, vertex in zip(names, vertices, strict=True)
    ]
    return told_apart(with_level, [f"v{number}" for number in range(len(vertices))])


def _lanes(part: TreePart, vertices: Sequence[Vertex], first: int) -> Iterator[Lane]:
    """Yield the lanes of a level, whose vertices begin with number `first`."""
    for _, lane in part.parts() if part.value else ():
        begin, end = (first + _vertex_number(lane[k], len(vertices) - first) for k in (0, 1))
        said = lane[2] if len(lane.value) > 2 else TreePart({}, lane.path, lane.place)
        if not isinstance(said.value, dict):
            said.refuse("is no mapping; here should be what the lane is, such as {speed_limit: 1}")
        limit = said["speed_limit"].number(0) if "speed_limit" in said.value else 0.0
        one, other = vertices[begin], vertices[end]
        seconds = seconds_of(math.dist((one.x, one.y), (other.x, other.y)), limit)
        yield Lane(begin, end, seconds)
        if said.value.get("is_bidirectional") is True:
            yield Lane(end, begin, seconds)


def _vertex_number(part: TreePart, count: int) -> int:
    """Return the vertex at an end of a lane; its level has `count`."""
    number = part.whole(0)
    if number >= count:
        part.refuse(f"is {number}, but this level has {count} vertices; they count from 0")
    return number


def _lifts(vertices: Sequence[Vertex]) -> Iterator[Lane]:
    """Yield ways between vertices of different levels in one lift."""
    for one, other in permutations(range(len(vertices)), 2):
        lift = vertices[one].lift
        is_same = lift and lift == vertices[other].lift
        if is_same and vertices[one].level != vertices[other].level:
            yield Lane(one, other, IN_A_LIFT)


def _robots(vertices: Sequence[Vertex], places: Sequence[Place]) -> Iterator[Robot]:
    start = next((key for key in STARTS if any(v.says(key) for v in vertices)), "")
    found = [(v, at) for v, at in zip(vertices, places, strict=True) if v.says(start)]
    names = [vertex.text("spawn_robot_name") for vertex, _ in found]
    others = [f"robot-{number + 1}" for number in range(len(found))]
    for name, (_, at) in zip(told_apart(names, others), found, strict=True):
        yield Robot(name, at, {CARRY: 1})


def _tasks(
    vertices: Sequence[Vertex], places: Sequence[Place], names: Sequence[str]
) -> Iterator[Task]:
    for vertex, at, name in zip(vertices, places, names, strict=True):
        for key, job in JOBS.items():
            if vertex.text(key):
                yield Task(f"{job} {name}", at, {CARRY: 1}, note=vertex.text(key))
