"""Home health care with double services (Mankowska and others 2014), as iolab-uniud/hhcrsp writes.

Caregivers leave the office and come back; a patient needs one service, or two by different
caregivers who start at once or so long after one another. Who starts after a patient's time window
is tardy. The cost is the mean of the distance, the total tardiness and the largest one.
Ways are in minutes, by a matrix that need not be symmetric: those of Mankowska are straight lines,
those of Kummer and of the Italian instances are by roads.
"""

from __future__ import annotations

from pathlib import Path

from teamformer.files.imports.trees import TreePart, read_json
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.roads import GROUND, Roads

COST = {"travel": 1.0, "tardiness": 1.0, "max_tardiness": 1.0}


def read(path: Path) -> list[Mission]:
    """Return the mission of an instance, a JSON file."""
    tree = read_json(path)
    patients = [part for _, part in tree["patients"].parts()]
    office = _office(tree)
    world = _read_roads(tree, [part["id"].text() for part in (office, *patients)])
    usual = {
        part["id"].text(): part["default_duration"].number(0)
        for _, part in tree["services"].parts()
    }
    caregivers = tree["caregivers"].parts()
    return [
        Mission(
            name=path.stem,
            world=world,
            capabilities=tuple(usual),
            robots=tuple(
                Robot(part["id"].text(), world.at(world.places[0]), _abilities(part))
                for _, part in caregivers
            ),
            tasks=tuple(
                task
                for part in patients
                for task in _services(part, world.at(part["id"].text()), usual)
            ),
            time="continuous",
            ends="home",
            cost=COST,
        )
    ]


def _office(tree: TreePart) -> TreePart:
    offices = tree["central_offices"].parts()
    if len(offices) > 1:
        tree["central_offices"].refuse(f"has {len(offices)} offices; here one is known")
    return offices[0][1]


def _read_roads(tree: TreePart, names: list[str]) -> Roads:
    ways = tree["distances"].ways(names)
    if len(set(names)) < len(names):
        twice = next(name for name in names if names.count(name) > 1)
        tree["patients"].refuse(f"has '{twice}' twice, as a patient or the office")
    return Roads(tuple(names), {GROUND: tuple(tuple(row) for row in ways.tolist())})


def _services(patient: TreePart, spot: Place, usual: dict[str, float]) -> list[Task]:
    """Return a patient's one or two services as tasks."""
    name, services = patient["id"].text(), patient["required_caregivers"].parts()
    if len(services) > 2:
        patient["required_caregivers"].refuse(f"has {len(services)} services; one or two are known")
    names = [name] if len(services) == 1 else _names(name, services)
    tasks: list[Task] = []
    for one, (_, service) in zip(names, services, strict=True):
        kind = service["service"].text()
        if kind not in usual:
            service["service"].refuse(f"is '{kind}', which is not under services")
        duration = service["duration"].number(0) if "duration" in service.value else usual[kind]
        begin, end = _pair(patient["time_window"])
        starts = {names[0]: _gap(patient)} if tasks else {}
        between = (begin, end + duration)
        tasks.append(Task(one, spot, {kind: 1}, duration, between=between, starts=starts))
    return tasks


def _names(patient: str, services: list[tuple[str, TreePart]]) -> list[str]:
    kinds = [part["service"].text() for _, part in services]
    if len(set(kinds)) < len(kinds):
        return [f"{patient}-{number}" for number in range(1, len(kinds) + 1)]
    return [f"{patient}-{kind}" for kind in kinds]


def _gap(patient: TreePart) -> tuple[float, float]:
    """Return how long after the first service the second one starts, at least and at most."""
    said = patient["synchronization"]
    kind = said["type"].text()
    if kind == "simultaneous":
        return 0.0, 0.0
    if kind != "sequential":
        said["type"].refuse(f"is '{kind}'; here should be simultaneous or sequential")
    return _pair(said["distance"])


def _pair(part: TreePart) -> tuple[float, float]:
    if len(part.parts()) != 2:
        part.refuse(f"has {len(part.parts())} entries; here should be two")
    one, two = part[0].number(0), part[1].number(0)
    if one > two:
        part.refuse(f"goes from {one:g} to {two:g}; the smaller one should come first")
    return one, two


def _abilities(caregiver: TreePart) -> dict[str, int]:
    return {part.text(): 1 for _, part in caregiver["abilities"].parts()}
