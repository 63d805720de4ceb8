"""Scenarios from the trees of their files (docs/reference/scenarios.md)."""

from __future__ import annotations

import difflib
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import zip_longest
from pathlib import Path
from typing import Any

from teamformer.errors import ScenarioError
from teamformer.grid import Place
from teamformer.mission.checks import LARGEST_NUMBER, LATEST_RETURN
from teamformer.mission.costs import COST_PARTS
from teamformer.mission.rules import HOME
from teamformer.model import Absence, Arrivals, Breakdown, Delays, Robot, Scenario, Task, World
from teamformer.plane import DECIMALS, Plane
from teamformer.roads import AIR, GROUND, Roads
from teamformer.scenarios.pins import Pinned, apply_pins, read_pins
from teamformer.scenarios.tree_reader import LONGEST_TEXT, Reader, name_of
from teamformer.scenarios.world_trees import read_world
from teamformer.scenarios.yaml.reader import Where
from teamformer.scenarios.yaml.words import describe, shorten

VERSION = 1

MOST_ALIKE = 1000
"""Robots that one entry of a file stands for."""

TOP_KEYS = {
    "teamformer": True,  # required
    "name": False,
    "world": True,
    "capabilities": True,
    "robots": True,
    "tasks": True,
    "teams": False,
    "sensing_radius": False,
    "join_radius": False,
    "forming_steps": False,
    "step_limit": False,
    "time": False,
    "ends": False,
    "forming": False,
    "cost": False,
    "finding_radius": False,
    "arrivals": False,
}
BY_METHOD = "delete it, and choose a method with --method"
BY_SUITE = "delete it; suites of bench can set it, under method_settings"
KEYS_OF_METHODS = {
    "order": BY_METHOD,
    "allocation": BY_METHOD,
    "new_tasks": BY_SUITE,
    "foresight": BY_SUITE,
}
"""What files said before methods did: how a mission is solved, not what it is; and what to do."""

ROBOT_KEYS = {
    "name": False,
    "at": True,
    "can": True,
    "speed": False,
    "lost": False,
    "back": False,
    "breaks": False,
    "delays": False,
    "moves": False,
    "count": False,
}
MOVES = (GROUND, AIR)
TASK_KEYS = {
    "name": False,
    "at": True,
    "needs": True,
    "duration": False,
    "appears": False,
    "after": False,
    "between": False,
    "starts": False,
    "to": False,
    "unload": False,
    "may_need": False,
    "within": False,
    "weight": False,
    "only": False,
    "with": False,
}
BREAKS_KEYS = {"rate": True, "repair": False}
ARRIVALS_KEYS = {"rate": True, "until": True, "needs": False, "duration": False}
DELAYS_KEYS = {"chance": True, "seed": True}


def read_tree(reader: Reader, name: str, folder: Path | None) -> Scenario | None:
    """Return the scenario in a reader's tree, or None after noting what is wrong with it.

    `name` is for a scenario without one; map files are looked for in `folder`.
    """
    top = reader.mapping((), _without_methods(reader), TOP_KEYS)
    if not _knows_version(reader, top):
        return None
    world = read_world(reader, top.get("world", {"grid": [1, 1]}), folder)
    rules = _read_rules(reader, top, world)
    robots, entries = _read_robots(reader, top.get("robots", []), world)
    if isinstance(world, Plane) and "arrival_radius" not in top["world"]:
        world = _with_usual_radius(world, robots)
    mission = Pinned(
        capabilities=tuple(reader.names(("capabilities",), top.get("capabilities", []))),
        robots=robots,
        tasks=_read_tasks(reader, top.get("tasks", []), world, rules.get("time")),
    )
    mission = _with_pins(reader, top, world, mission)
    parts = {
        "name": reader.text(("name",), top.get("name", name)),
        "world": world,
        "capabilities": mission.capabilities,
        "robots": mission.robots,
        "tasks": mission.tasks,
        "teams": _read_teams(reader, top.get("teams", []), [robot.name for robot in robots]),
        **rules,
    }
    if not reader.is_faithful:  # the model would complain about what stands in for the mistakes
        return None
    try:
        return Scenario(**parts)
    except ScenarioError as error:
        for problem in error.problems:
            reader.refuse(_in_file(problem.where, entries), problem.message)
        return None


def _in_file(where: Where, entries: Sequence[int]) -> Where:
    """Return where in the file something of the scenario is: an entry may be many robots."""
    if len(where) < 2 or where[0] != "robots":
        return where
    return ("robots", entries[int(where[1])], *where[2:])


def _knows_version(reader: Reader, top: Mapping[str, Any]) -> bool:
    version = reader.whole(("teamformer",), top.get("teamformer", VERSION), least=1)
    if version > VERSION:
        reader.tree.problems.clear()  # keys unknown to us may be right there
        reader.refuse(
            ("teamformer",),
            f"this is format {version}, and this teamformer knows up to {VERSION}; "
            "install a newer one",
        )
    return version <= VERSION


def _read_robots(reader: Reader, value: Any, world: World) -> tuple[tuple[Robot, ...], list[int]]:
    """Return the robots, and for each the entry of the file that it comes from."""
    robots: list[Robot] = []
    entries: list[int] = []
    for number, part in enumerate(reader.sequence(("robots",), value)):
        where = ("robots", number)
        keys = reader.mapping(where, part, ROBOT_KEYS)
        count, longest = 1, LONGEST_TEXT
        if "count" in keys:
            count = reader.whole((*where, "count"), keys["count"], 1, MOST_ALIKE)
            longest -= len(f"-{count}")
        robot = Robot(
            name=reader.text((*where, "name"), keys.get("name", f"r{len(robots) + 1}"), longest),
            at=_read_at(reader, (*where, "at"), keys.get("at"), world),
            can=reader.counts((*where, "can"), keys.get("can", [])),
            speed=reader.number((*where, "speed"), keys.get("speed", 1.0)),
            absences=_read_absences(reader, where, keys),
            breaks=_read_breaks(reader, (*where, "breaks"), keys),
            delays=_read_delays(reader, (*where, "delays"), keys.get("delays")),
            moves=_read_moves(reader, (*where, "moves"), keys.get("moves", GROUND), world),
        )
        if "count" not in keys:
            alike = [robot]
        elif "name" in keys:
            alike = [replace(robot, name=f"{robot.name}-{n + 1}") for n in range(count)]
        else:
            alike = [replace(robot, name=f"r{len(robots) + n + 1}") for n in range(count)]
        robots += alike
        entries += [number] * len(alike)
    return tuple(robots), entries


def _read_at(reader: Reader, where: Where, value: Any, world: World) -> Place:
    """Return where something is: `[x, y]`, on roads the name of a place. None was told before."""
    if not isinstance(world, Roads):
        return reader.place(where, [0, 0] if value is None else value, isinstance(world, Plane))
    if value is None or not world.places:  # roads that are wrong were told
        return 0, 0
    if isinstance(value, list | dict):
        reader.refuse(where, f"{name_of(where)} is {describe(value)}; on roads name a place")
        return 0, 0
    name = reader.text(where, value)
    if name in world.places:
        return world.at(name)
    near = difflib.get_close_matches(name, world.places, 1)
    remedy = f"did you mean '{near[0]}'?" if near else "name a place that has a row there"
    reader.refuse(where, f"{name_of(where)} is '{shorten(name)}', which is on no road; {remedy}")
    return 0, 0


def _read_moves(reader: Reader, where: Where, value: Any, world: World) -> str:
    """Return how a robot moves: on the ground, in the air or, on roads, by a table's name."""
    word = reader.text(where, value)
    if word not in MOVES and not isinstance(world, Roads):
        reader.refuse(where, f"{name_of(where)} is '{word}'; write {' or '.join(MOVES)}")
    return word


def _read_absences(reader: Reader, where: Where, keys: Mapping[str, Any]) -> tuple[Absence, ...]:
    """Return when a robot is lost and back: `lost` and `back` are a step each, or lists."""
    lost = _read_steps(reader, (*where, "lost"), keys.get("lost", []), LARGEST_NUMBER)
    back = _read_steps(reader, (*where, "back"), keys.get("back", []), LATEST_RETURN)
    if len(back) > len(lost):
        what = "is back but never lost" if not lost else "is back more often than it is lost"
        name = keys.get("name", name_of(where))
        reader.refuse((*where, "back"), f"robot '{name}' {what}; add lost or drop back")
    return tuple(Absence(*pair) for pair in zip_longest(lost, back[: len(lost)]))


def _read_steps(reader: Reader, where: Where, value: Any, latest: int) -> list[int]:
    if not isinstance(value, list):
        return [reader.whole(where, value, most=latest)]
    return [
        reader.whole((*where, number), steps, most=latest) for number, steps in enumerate(value)
    ]


def _with_usual_radius(plane: Plane, robots: tuple[Robot, ...]) -> Plane:
    """Let the places of a plane be no wider than what the slowest robot walks in a step."""
    slowest = min((plane.pace(robot.speed) for robot in robots), default=math.inf)
    if not 0 < slowest < plane.arrival_radius:
        return plane
    return replace(plane, arrival_radius=round(slowest, DECIMALS))


def _read_tasks(reader: Reader, value: Any, world: World, time: str | None) -> tuple[Task, ...]:
    tasks = []
    for number, part in enumerate(reader.sequence(("tasks",), value)):
        where = ("tasks", number)
        keys = reader.mapping(where, part, TASK_KEYS)
        tasks.append(
            Task(
                name=reader.text((*where, "name"), keys.get("name", f"t{number + 1}")),
                at=_read_at(reader, (*where, "at"), keys.get("at"), world),
                needs=reader.counts((*where, "needs"), keys.get("needs", [])),
                duration=_read_duration(reader, (*where, "duration"), keys, time),
                lasts=_read_lasts(reader, (*where, "duration"), keys.get("duration")),
                may_need=_read_chances(reader, (*where, "may_need"), keys.get("may_need", {})),
                within=reader.number((*where, "within"), keys.get("within", 0.0)),
                weight=reader.number((*where, "weight"), keys.get("weight", 1.0)),
                appears=reader.whole((*where, "appears"), keys.get("appears", 0)),
                after=tuple(reader.names((*where, "after"), keys.get("after", []))),
                between=_read_window(reader, (*where, "between"), keys),
                starts=_read_links(reader, (*where, "starts"), keys.get("starts", {})),
                to=_read_at(reader, (*where, "to"), keys["to"], world) if "to" in keys else None,
                unload=_read_time(reader, (*where, "unload"), keys.get("unload", 0), time),
            )
        )
    return tuple(tasks)


def _with_pins(reader: Reader, top: Mapping[str, Any], world: World, mission: Pinned) -> Pinned:
    """Return a mission with the pins of its tasks said in capabilities."""
    pins, any_are = [], False
    listed = top.get("tasks")
    number_of = {robot.name: number for number, robot in enumerate(mission.robots)}
    for number, keys in enumerate(listed if isinstance(listed, list) else ()):
        said = keys if isinstance(keys, dict) else {}
        any_are |= "only" in said or "with" in said
        pins.append(read_pins(reader, ("tasks", number), said, number_of))
    if not any_are or not reader.is_faithful:
        return mission
    if "arrivals" in top:
        message = "tasks that appear at random may need anything, pins too"
        reader.refuse(("arrivals",), f"{message}; drop arrivals, or only and with of the tasks")
    return apply_pins(reader, world, mission, pins)


def _read_duration(
    reader: Reader, where: Where, keys: Mapping[str, Any], time: str | None
) -> float:
    value = keys.get("duration", 0)
    if isinstance(value, list):  # what to expect follows from the range
        return 0
    return _read_time(reader, where, value, time)


def _read_time(reader: Reader, where: Where, value: Any, time: str | None) -> float:
    return reader.number(where, value) if time == "continuous" else reader.whole(where, value)


def _read_lasts(reader: Reader, where: Where, value: Any) -> tuple[int, int] | None:
    """Return the least and the most steps that a task takes; None if a number stands there."""
    if not isinstance(value, list):
        return None
    return _read_range(reader, where, value, "write steps, or [least, most]")


def _read_range(reader: Reader, where: Where, value: Any, remedy: str) -> tuple[int, int] | None:
    """Return the least and the most of a number of steps; None after refusing what is no range."""
    pair = reader.pair(where, value, remedy)
    if pair is None:
        return None
    least, most = (reader.whole((*where, part), steps) for part, steps in enumerate(pair))
    return least, most


def _read_chances(reader: Reader, where: Where, value: Any) -> dict[str, float]:
    """Return probabilities by capability."""
    if not isinstance(value, dict):
        message = f"{name_of(where)} is {describe(value)}; write a mapping to probabilities"
        reader.refuse(where, f"{message}, such as {{weld: 0.4}}")
        return {}
    return {
        reader.text((*where, name), name): reader.number((*where, name), chance)
        for name, chance in value.items()
    }


def _read_breaks(reader: Reader, where: Where, keys: Mapping[str, Any]) -> Breakdown | None:
    if "breaks" not in keys:
        return None
    said = reader.mapping(where, keys["breaks"], BREAKS_KEYS)
    rate = reader.number((*where, "rate"), said.get("rate", 0.0))
    if "repair" not in said:
        return Breakdown(rate)
    remedy = "write it as [least, most]"
    return Breakdown(rate, _read_range(reader, (*where, "repair"), said["repair"], remedy))


def _read_delays(reader: Reader, where: Where, value: Any) -> Delays | None:
    if value is None:
        return None
    if not isinstance(value, dict):
        return Delays(reader.number(where, value))
    said = reader.mapping(where, value, DELAYS_KEYS)
    chance = reader.number((*where, "chance"), said.get("chance", 0.0))
    return Delays(chance, reader.whole((*where, "seed"), said.get("seed", 0)))


def _read_window(
    reader: Reader, where: Where, keys: Mapping[str, Any]
) -> tuple[float, float] | None:
    if "between" not in keys:
        return None
    return _read_pair(reader, where, keys["between"], "[begin, end]")


def _read_links(reader: Reader, where: Where, value: Any) -> dict[str, tuple[float, float]]:
    if not isinstance(value, dict):
        reader.refuse(
            where, f"{name_of(where)} is {describe(value)}; write {{TASK: [least, most]}}"
        )
        return {}
    read = {
        reader.text((*where, name), name): _read_pair(reader, (*where, name), gap, "[least, most]")
        for name, gap in value.items()
    }
    return {name: gap for name, gap in read.items() if gap is not None}


def _read_pair(reader: Reader, where: Where, value: Any, form: str) -> tuple[float, float] | None:
    pair = reader.pair(where, value, f"write it as {form}")
    if pair is None:
        return None
    begin, end = (reader.number((*where, part), time) for part, time in enumerate(pair))
    return begin, end


def _read_teams(reader: Reader, value: Any, robots: list[str]) -> tuple[tuple[int, ...], ...]:
    number_of = {name: number for number, name in reversed(list(enumerate(robots)))}
    teams = []
    for number, part in enumerate(reader.sequence(("teams",), value)):
        where = ("teams", number)
        names = reader.names(where, part)
        for entry, name in enumerate(names):
            if name not in number_of and name != "?":
                reader.refuse(
                    (*where, entry), f"there is no robot '{shorten(name)}'; write the name of one"
                )
        teams.append(tuple(number_of.get(name, 0) for name in names))
    return tuple(teams)


def _without_methods(reader: Reader) -> Any:
    """Return the file's tree without keys that say how to solve a mission; refuse those."""
    tree = reader.tree.value
    if not isinstance(tree, dict):
        return tree
    for key, remedy in KEYS_OF_METHODS.items():
        if key in tree:
            what = f"'{key}' says how to solve the mission, not what it is"
            reader.refuse((key,), f"{what}; {remedy}")
    return {key: value for key, value in tree.items() if key not in KEYS_OF_METHODS}


def _read_rules(reader: Reader, top: Mapping[str, Any], world: World) -> dict[str, Any]:
    """Return the rules that the file sets; the others keep the model's defaults."""
    rules: dict[str, Any] = {}
    for key in ("sensing_radius", "join_radius", "finding_radius"):
        if key in top:
            rules[key] = reader.number((key,), top[key], can_be_infinite=True)
    for key, least in (("forming_steps", 0), ("step_limit", 1)):
        if key in top:
            rules[key] = reader.whole((key,), top[key], least)
    if "time" in top:
        rules["time"] = reader.word(top["time"])
    if "forming" in top:
        rules["forming"] = reader.number(("forming",), top["forming"])
    if "arrivals" in top:
        rules["arrivals"] = _read_arrivals(reader, top["arrivals"])
    if "cost" in top:
        rules["cost"] = _read_cost(reader, top["cost"])
    if "ends" in top:
        ends = top["ends"]
        is_name = isinstance(world, Roads) and ends != HOME
        is_place = isinstance(ends, list) or is_name
        rules["ends"] = _read_at(reader, ("ends",), ends, world) if is_place else reader.word(ends)
    return rules


def _read_arrivals(reader: Reader, value: Any) -> Arrivals:
    said = reader.mapping(("arrivals",), value, ARRIVALS_KEYS)
    most = reader.whole(("arrivals", "needs"), said["needs"], 1) if "needs" in said else 0
    return Arrivals(
        reader.number(("arrivals", "rate"), said.get("rate", 0.0)),
        reader.whole(("arrivals", "until"), said.get("until", 0)),
        most,
        reader.whole(("arrivals", "duration"), said.get("duration", 0)),
    )


def _read_cost(reader: Reader, value: Any) -> dict[str, float]:
    weights = reader.mapping(("cost",), value, dict.fromkeys(COST_PARTS, False))
    return {name: reader.number(("cost", name), weight) for name, weight in weights.items()}
