"""Small missions over the whole file format, as trees: all of them are good files."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from hypothesis import strategies as st

from drawing import are_more, now_and_then, pick, some
from teamformer.base.errors import MissionError
from teamformer.files.mission_files import mission_from_tree
from teamformer.mission.keys.kinds import LONGEST_TEXT, Kind, Number, OneOf, Text, Whole
from teamformer.mission.keys.mission_keys import COST_KEYS
from teamformer.mission.keys.robot_keys import ROBOT_KEYS
from teamformer.mission.keys.task_keys import TASK_KEYS
from words import draw_names
from worlds import Drawn, Place, draw_world

Tree = dict[str, Any]

SEEDS = st.integers(0, 30)
MOST_ROBOTS, MOST_TASKS, MOST_CAPABILITIES = 5, 5, 4

SPEEDS = (1, 0.5, 0.3, 1.7, 2, 0.8)
CHANCES = (0.4, 0, 1, 0.1, 0.9)
RADII = (0, 1, 2.5, 0.3, ".inf")
RADII_BY_SIZE = (0, 0.3, 1, 2.5, ".inf")
GRAINS = (1000, 1000, 1000, 500, 333, 20_250, 1)
"""What robots bring whole multiples of, in thousandths."""

RULES: dict[str, tuple[Any, ...]] = {
    "sensing_radius": RADII,
    "forming_steps": (0, 1),
    "finding_radius": RADII,
}
RANGES = ([0, 0], [0, 1], [2, 2], [1, 5], [4, 10], [0, 7])
REPAIRS = ([1, 1], [2, 9], [5, 18])
TIMES = (1, 0, 0.5, 3, 2.25, 7.01, 1 / 3)
WEIGHTS = (1, 0.001, 0.5, 3, 3000, 1_000_000)
COSTS = tuple(key.name for key in COST_KEYS if key.name != "missed")
COSTS_IN_STEPS = tuple(part for part in COSTS if part != "travel")

ENDS, ENDS_IN_STEPS = (8, 30.5, 3, 100), (8, 30, 3, 100)
"""When missions are over."""


@dataclass(frozen=True)
class Fleet:
    """Robots as they stand in a file, one an entry, and what they bring to each part of the world.

    Counts are in thousandths.
    """

    grain: Mapping[str, int]
    robots: list[Tree] = field(default_factory=list)
    brought: dict[int, dict[str, int]] = field(default_factory=dict)

    @property
    def everything(self) -> dict[str, int]:
        """Return what all bring together."""
        brings = [_thousandths(robot["can"]) for robot in self.robots]
        caps = {cap for can in brings for cap in can}
        return {cap: sum(can.get(cap, 0) for can in brings) for cap in caps}


@st.composite
def missions(
    draw: st.DrawFn,
    is_sure: bool = False,
    is_for_fleets: bool = False,
    is_tiny: bool = False,
    has_cancelled: bool = True,
) -> Tree:
    """Return a mission in steps.

    `is_sure` leaves out what nobody knows beforehand. One that `is_for_fleets` has nothing that
    fleets of processes refuse: of what is not known, nothing that befalls robots, and no loads. One
    that `is_tiny` has two robots and tasks at most. Without `has_cancelled` nothing is called off:
    `central` plans it.
    """
    most_robots, most_tasks = (2, 2) if is_tiny else (MOST_ROBOTS, MOST_TASKS)
    is_sure = is_sure or pick(draw, (True, False, False))
    world, caps = draw_world(draw), draw_names(draw, 1 + pick(draw, range(MOST_CAPABILITIES)))
    fleet = _draw_fleet(draw, world, caps, most_robots)
    for robot in fleet.robots:
        _write_losses(draw, robot)
        if not is_sure and not is_for_fleets:
            _write_surprises_of_robot(draw, robot)
    tasks = _draw_tasks(draw, world, fleet, most_tasks)
    for task in tasks:
        if now_and_then(draw, 2):
            task["duration"] = pick(draw, (1, 0, 2, 4))
        if now_and_then(draw):
            task["appears"] = pick(draw, (3, 0, 1, 9, 20))
        if has_cancelled and not is_tiny and now_and_then(draw):
            task["cancelled"] = pick(draw, (5, 1, 3, 12, 30))
        if not is_sure:
            _write_surprises_of_task(draw, world, fleet, task)
    flies = any(robot.get("moves") == "air" for robot in fleet.robots)
    if not is_tiny and not flies:  # `plain_search` plays no loads, and nobody flies with them
        sure = [task for task in tasks if not is_for_fleets or "within" not in task]
        _write_loads(draw, world, sure)
    _write_windows(draw, tasks, can_be_short=True)
    _write_precedence(draw, tasks, range(len(tasks)))
    _keep_windows_possible(tasks, step=1)
    if not (is_tiny or is_for_fleets) and now_and_then(draw):  # `plain_search` knows no shifts
        _write_shifts_in_steps(draw, fleet.robots, tasks)
    tree = _write(draw, world, caps, fleet.robots, tasks)
    _keep_shifts_possible(tree)
    if not (is_tiny or is_for_fleets) and now_and_then(draw):
        _write_zones(draw, tree, world)
    for key, values in RULES.items():
        if now_and_then(draw, 3):
            tree[key] = pick(draw, values)
    if not is_sure or "plane" in world.tree or now_and_then(draw, 3):  # else it is not far away
        tree["step_limit"] = pick(draw, (200, 200, 60, 7, 1))
    if now_and_then(draw, 3):
        radii = (tree.get("sensing_radius", 1), pick(draw, RADII))
        tree["join_radius"] = min(radii, key=RADII_BY_SIZE.index)
    if now_and_then(draw, 3):
        _write_cost(draw, tree, COSTS_IN_STEPS)
    if now_and_then(draw):
        _write_pins(draw, tree, world)
    elif not (is_sure or is_for_fleets) and now_and_then(draw, 3) and _can_more_appear(tree, world):
        tree["arrivals"] = {"rate": pick(draw, (0.1, 0, 1)), "until": pick(draw, (8, 0, 1, 5))}
        for key, values in (("needs", (1, 2, 9)), ("duration", (1, 0, 3)), ("since", (2, 0, 9))):
            if now_and_then(draw, 2):
                tree["arrivals"][key] = pick(draw, values)
    return _write_details(draw, tree)


@st.composite
def optional_missions(
    draw: st.DrawFn, most_robots: int = MOST_ROBOTS, is_in_steps: bool = False
) -> Tree:
    """Return a mission that is over at a time, and may leave tasks out."""
    timed = missions() if is_in_steps else continuous_missions(most_robots=most_robots)
    tree = draw(timed)
    tree["until"] = pick(draw, ENDS_IN_STEPS if is_in_steps else ENDS)
    tasks = {task.get("name", f"t{number + 1}"): task for number, task in enumerate(tree["tasks"])}
    may = {name for name in tasks if now_and_then(draw, 2)}
    for _ in tasks:  # what comes after optional tasks, or is linked with them, is optional, too
        for name, task in tasks.items():
            linked = {*task.get("starts", ()), name}
            may |= linked if linked & may else set()
            may |= {name} if may.intersection(task.get("after", ())) else set()
    for name in may:
        tasks[name]["optional"] = True
        if now_and_then(draw, 2):
            tasks[name]["weight"] = pick(draw, WEIGHTS)
    if may and "cost" in tree:
        tree["cost"]["missed"] = pick(draw, WEIGHTS)
    return tree


@st.composite
def continuous_missions(
    draw: st.DrawFn, most_robots: int = MOST_ROBOTS, most_tasks: int = MOST_TASKS
) -> Tree:
    """Return a mission in continuous time."""
    world = draw_world(draw, can_be_roads=True)
    caps = draw_names(draw, 1 + pick(draw, range(MOST_CAPABILITIES)))
    fleet = _draw_fleet(draw, world, caps, most_robots)
    tasks = _draw_tasks(draw, world, fleet, most_tasks)
    for task in tasks:
        if now_and_then(draw, 2):
            task["duration"] = pick(draw, TIMES)
        if now_and_then(draw):
            task["appears"] = pick(draw, (3, 0, 9))
    _write_loads(draw, world, tasks)
    _write_windows(draw, tasks, can_be_short=False)
    group_of = _write_links(draw, tasks, fleet)
    if not any("starts" in task for task in tasks) and now_and_then(draw, 3):
        _write_shifts(draw, fleet.robots, tasks)
    _write_precedence(draw, tasks, group_of)
    _keep_windows_possible(tasks, step=0)
    tree = {"time": "continuous", **_write(draw, world, caps, fleet.robots, tasks)}
    parts = {world.part(robot["at"]) for robot in fleet.robots}
    ends = ["home", *(place for place in world.places if parts == {world.part(place)})]
    if now_and_then(draw, 2):
        tree["ends"] = pick(draw, ends)
    if now_and_then(draw, 2):
        tree["forming"] = pick(draw, TIMES)
    if now_and_then(draw, 3):
        _write_cost(draw, tree, COSTS)
    if _needs_a_robot_twice(tree):
        for task in tree["tasks"]:
            task.pop("starts", None)
    _keep_shifts_possible(tree)
    if now_and_then(draw, 3):
        _write_zones(draw, tree, world)
    return _write_details(draw, tree)


def _write_zones(draw: st.DrawFn, tree: Tree, world: Drawn) -> None:
    """Say in which zones tasks are, and where loads go: by name, by place, or in an area."""
    named = [task["name"] for task in tree["tasks"] if "name" in task]
    goals = [task["to"] for task in tree["tasks"] if "to" in task]
    is_road = "roads" in world.tree
    zones: Tree = {}
    if named:
        zones["by name"] = {"tasks": named[: 1 + pick(draw, range(len(named)))]}
    at = pick(draw, [*(task["at"] for task in tree["tasks"]), *goals])
    zones["by place"] = {"places": [at]}
    if not is_road:
        reach = 3 if isinstance(at[0], int) else 3 * world.unit
        zones["an area"] = {"area": [at, [at[0] + reach, at[1]]]}
    for zone in zones.values():
        if now_and_then(draw, 2):
            zone["room"] = pick(draw, (1, 2, 1000))
    if zones:
        tree["zones"] = zones
    if _has_narrow_zones(tree):
        for zone in zones.values():
            zone["room"] = len(tree["tasks"])


def _has_narrow_zones(tree: Tree) -> bool:
    """Say whether linked tasks go on at once in a zone that has no room for them."""
    return _is_refused(tree, "by their links")


def _needs_a_robot_twice(tree: Tree) -> bool:
    """Say whether linked tasks, which different robots do, need one robot at once."""
    return _is_refused(tree, "done by different robots")


def _keep_shifts_possible(tree: Tree) -> None:
    """Let everybody always work if shifts leave no time for a task, with the ways that it takes."""
    if _is_refused(tree, "no shift that long") or _is_refused(tree, "within their shifts"):
        for robot in tree["robots"]:
            robot.pop("shifts", None)
            robot.pop("every", None)


def _is_refused(tree: Tree, because: str) -> bool:
    try:
        mission_from_tree({"teamformer": 1} | tree)
    except MissionError as error:
        return any(because in it.message for it in error.problems)
    return False


def _draw_fleet(
    draw: st.DrawFn, world: Drawn, caps: Sequence[str], most: int, can_fly: bool = True
) -> Fleet:
    fleet = Fleet({cap: pick(draw, GRAINS) if now_and_then(draw) else 1000 for cap in caps})
    homes = [pick(draw, world.places), pick(draw, world.places)]
    while are_more(draw, fleet.robots, most):
        fleet.robots.append(draw(_robots(world, caps, homes, fleet, can_fly)))
    return fleet


@st.composite
def _robots(
    draw: st.DrawFn,
    world: Drawn,
    caps: Sequence[str],
    homes: Sequence[Place],
    fleet: Fleet,
    can_fly: bool,
) -> Tree:
    at = pick(draw, homes if now_and_then(draw, 2) else (homes[0], pick(draw, world.places)))
    can = {cap: (1 + now_and_then(draw)) * fleet.grain[cap] for cap in some(draw, caps, 3)}
    robot = {"at": at, "can": _written(draw, can)}
    if now_and_then(draw, 3):
        robot["speed"] = pick(draw, SPEEDS)
    if world.movers and now_and_then(draw, 2):
        robot["moves"] = pick(draw, world.movers)
    parts = {world.part(at)}
    if can_fly and "roads" not in world.tree and now_and_then(draw):
        robot["moves"] = "air"
        parts = {world.part(place) for place in world.places}
    for part in parts:
        have = fleet.brought.setdefault(part, {})
        for cap, count in can.items():
            have[cap] = have.get(cap, 0) + count
    return robot


def _write_losses(draw: st.DrawFn, robot: Tree) -> None:
    """Say when a robot is lost and back: never, once, or again and again."""
    times = pick(draw, (0, 0, 0, 0, 0, 1, 2, 3, 4))
    steps, at = [], 0
    for _ in range(times):
        at += 1 + pick(draw, range(12))
        steps.append(at)
    for key, own in (("lost", steps[::2]), ("back", steps[1::2])):
        if own:
            robot[key] = own if times > 2 or now_and_then(draw) else own[0]


def _write_surprises_of_robot(draw: st.DrawFn, robot: Tree) -> None:
    if "lost" not in robot and now_and_then(draw):
        robot["breaks"] = {"rate": pick(draw, (0.02, 0, 0.2, 1))}
        if now_and_then(draw, 2):
            robot["breaks"]["repair"] = pick(draw, REPAIRS)
    if now_and_then(draw):
        chance = pick(draw, (0.1, 0, 0.5, 0.9))
        robot["delays"] = {"chance": chance, "seed": 3} if now_and_then(draw) else chance


def _draw_tasks(draw: st.DrawFn, world: Drawn, fleet: Fleet, most: int) -> list[Tree]:
    places = [place for place in world.places if world.part(place) in fleet.brought]
    tasks: list[Tree] = []
    while are_more(draw, tasks, most):
        tasks.append(draw(_plain_tasks(world, fleet, places)))
    return tasks


@st.composite
def _plain_tasks(draw: st.DrawFn, world: Drawn, fleet: Fleet, places: Sequence[Place]) -> Tree:
    at = pick(draw, places)
    have, needs = fleet.brought[world.part(at)], {}
    for cap in some(draw, sorted(have), 3):
        grain = fleet.grain[cap]
        needs[cap] = grain * (1 + pick(draw, range(min(have[cap] // grain, 3))))
        if grain != 1000 and now_and_then(draw):
            needs[cap] -= pick(draw, range(grain))
    return {"at": at, "needs": _written(draw, needs)}


def _write_surprises_of_task(draw: st.DrawFn, world: Drawn, fleet: Fleet, task: Tree) -> None:
    """Say what is not known of a task; the worst of it can be met all the same."""
    part = world.part(task["at"])
    have, needs = fleet.brought[part], _thousandths(task["needs"])
    spare = [cap for cap in sorted(have) if have[cap] >= needs.get(cap, 0) + 1000]
    if now_and_then(draw):
        task["duration"] = pick(draw, RANGES)
    if spare and now_and_then(draw, 3):
        task["may_need"] = {cap: pick(draw, CHANCES) for cap in some(draw, spare, 2)}
    if now_and_then(draw):
        task["within"] = pick(draw, (1, 0, 2.5, 4)) * world.unit
        beside = [p for p in world.blocked if _part_around(world, p, task["within"]) == part]
        if beside and now_and_then(draw, 2):
            task["at"] = pick(draw, beside)


def _part_around(world: Drawn, at: Place, within: float) -> int | None:
    """Return the part that the free cells around a wall lie in; None if there are several."""
    near = {
        world.part(place)
        for place in world.places
        if (place[0] - at[0]) ** 2 + (place[1] - at[1]) ** 2 <= within**2
    }
    return near.pop() if len(near) == 1 else None


def _write_loads(draw: st.DrawFn, world: Drawn, tasks: Sequence[Tree]) -> None:
    """Say where some tasks are brought, and how long that takes there; on roads none is."""
    for task in tasks if "roads" not in world.tree else ():
        part = _part_of(world, task)
        near = [place for place in world.places if world.part(place) == part]
        if near and now_and_then(draw):
            task["to"] = pick(draw, near)
            if now_and_then(draw, 2):
                task["unload"] = pick(draw, (1, 0, 4))


def _part_of(world: Drawn, task: Tree) -> int | None:
    """Return the part of the map that a task lies in; None if it may lie in several."""
    return _part_around(world, task["at"], task.get("within", 0))


def _write_windows(draw: st.DrawFn, tasks: Sequence[Tree], can_be_short: bool) -> None:
    """Say when some tasks have to wait, and when they are late, be it that they cannot but be."""
    for task in tasks:
        if now_and_then(draw):
            begin, length = pick(draw, (0, 3, 2.5, 20)), pick(draw, (1, 0.5, 6, 20))
            task["between"] = [
                begin,
                begin + length + (0 if can_be_short else task.get("duration", 0)),
            ]


def _write_shifts(draw: st.DrawFn, robots: Sequence[Tree], tasks: Sequence[Tree]) -> None:
    """Say when some robots work: a shift that all have in common, and perhaps others."""
    longest = max(task.get("duration", 0) + task.get("unload", 0) for task in tasks)
    common = longest + pick(draw, (0, 0.5, 2, 7))
    begin, last = pick(draw, (0, 1, 3.5)), common + 20
    every = pick(draw, (last, last + 3, 0))
    for robot in robots:
        if now_and_then(draw, 2):
            shifts = [[begin, begin + common]]
            if common and now_and_then(draw, 2):
                shifts.append([begin + common + pick(draw, (0, 1, 4)), begin + last - 6])
            robot["shifts"] = shifts if common else [[begin, begin + 4]]
            if every:
                robot["every"] = every
            else:
                robot["shifts"].append([begin + last, 10_000])


def _write_shifts_in_steps(draw: st.DrawFn, robots: Sequence[Tree], tasks: Sequence[Tree]) -> None:
    """Say when some robots work: a shift that all have in common, and perhaps others.

    It has room for the longest task, and for those that appear.
    """
    durations = (task.get("duration", 0) for task in tasks)
    longest = max(lasts[1] if isinstance(lasts, list) else lasts for lasts in durations)
    unload = max(task.get("unload", 0) for task in tasks)
    begin, common = pick(draw, (0, 1, 4)), max(3, longest + unload) + 1 + pick(draw, (0, 2, 9))
    every = pick(draw, (common + 8, common + 11, 0))
    for robot in robots:
        if now_and_then(draw, 2):
            robot["shifts"] = [[begin, begin + common]]
            if now_and_then(draw, 2):
                again = begin + common + pick(draw, (0, 1, 3))
                robot["shifts"].append([again, begin + common + 8])
            if every:
                robot["every"] = every
            else:
                robot["shifts"].append([begin + common + 9, 10_000])


def _write_precedence(draw: st.DrawFn, tasks: Sequence[Tree], group_of: Sequence[int]) -> None:
    """Say which tasks come after others, by number until they have names; never within a group."""
    for number, task in enumerate(tasks):
        earlier = [other for other in range(number) if group_of[other] != group_of[number]]
        if earlier and now_and_then(draw):
            task["after"] = some(draw, earlier, 2)


def _keep_windows_possible(tasks: Sequence[Tree], step: int) -> None:
    """Have no window end before the tasks that come first can be done; `step` is what each adds."""
    ends: list[float] = []
    for task in tasks:
        begin = max(task.get("appears", 0), task.get("between", [0])[0])
        begin = max(
            [math.ceil(begin) if step else begin, *(ends[n] for n in task.get("after", ()))]
        )
        takes = task.get("duration", 0)
        takes = takes[0] if isinstance(takes, list) else takes
        ends.append(begin + takes + task.get("unload", 0) + step)
        if "after" in task and "between" in task:
            task["between"][1] = max(task["between"][1], ends[-1])


def _write_links(draw: st.DrawFn, tasks: Sequence[Tree], fleet: Fleet) -> list[int]:
    """Link the starts of some tasks that stand beside one another; return the groups of all."""
    group_of, have = list(range(len(tasks))), fleet.everything
    for number in range(1, len(tasks)):
        group = [n for n in range(number) if group_of[n] == group_of[number - 1]] + [number]
        wanted = [_thousandths(tasks[n]["needs"]) for n in group]
        can_be = all(
            have[cap] >= sum(needs.get(cap, 0) for needs in wanted)
            for needs in wanted
            for cap in needs
        )
        if can_be and len(group) <= len(fleet.robots) and now_and_then(draw, 3):
            least, more = pick(draw, (0, 1, 6)), pick(draw, (0, 2, 0.5))
            tasks[number]["starts"] = {number - 1: [least, least + more]}
            group_of[number] = group_of[number - 1]
    return group_of


def _write_cost(draw: st.DrawFn, tree: Tree, parts: Sequence[str]) -> None:
    """Say what counts, and of some tasks how much."""
    tree["cost"] = {part: pick(draw, WEIGHTS) for part in some(draw, parts, 4)}
    for task in tree["tasks"]:
        if now_and_then(draw):
            task["weight"] = pick(draw, WEIGHTS)


def _write_pins(draw: st.DrawFn, tree: Tree, world: Drawn) -> None:
    """Say of some tasks who takes part in any case, and that only those do who can get there.

    A pin is one more capability, or one for each need; some networks know four at most.
    """
    room = MOST_CAPABILITIES - len(tree["capabilities"])
    robots = [robot for robot in tree["robots"] if "count" not in robot]
    names = {id(robot): robot.get("name", f"r{n + 1}") for n, robot in enumerate(tree["robots"])}
    for task in tree["tasks"]:
        if task["at"] not in world.places or not now_and_then(draw, 2):
            continue
        part = world.part(task["at"])
        near = [r for r in robots if "moves" in r or world.part(r["at"]) == part]
        wanted = len({*task["needs"], *task.get("may_need", ())})
        if near and room >= 2 and now_and_then(draw, 2):
            task["with"] = [names[id(robot)] for robot in some(draw, near, 2)]
            room -= len(task["with"])
        elif all("count" not in r or "name" in r for r in tree["robots"]) and room >= wanted:
            near = [r for r in tree["robots"] if "moves" in r or world.part(r["at"]) == part]
            task["only"] = [names[id(robot)] for robot in near]  # alike ones by their one name
            room -= wanted


def _write_details(draw: st.DrawFn, tree: Tree) -> Tree:
    """Say what details show and nothing else depends on; its values are drawn by kind."""
    for key in (*ROBOT_KEYS, *TASK_KEYS):
        things = tree["robots"] if key in ROBOT_KEYS else tree["tasks"]
        if key.is_in_details and now_and_then(draw, 3):
            pick(draw, things)[key.name] = _of_kind(draw, key.kind)
    return tree


def _of_kind(draw: st.DrawFn, kind: Kind) -> Any:
    match kind:
        case Text():
            return draw_names(draw, 1)[0]
        case OneOf():
            return pick(draw, kind.choices)
        case Number() | Whole():
            return pick(draw, [bound for bound in (kind.least, kind.most) if bound is not None])
    raise NotImplementedError(kind)


def _can_more_appear(tree: Tree, world: Drawn) -> bool:
    """Say whether wherever robots start they bring a whole one of something together."""
    have: dict[int, dict[str, int]] = {}
    for robot in tree["robots"]:
        part = have.setdefault(world.part(robot["at"]), {})
        for cap, count in _thousandths(robot["can"]).items():
            part[cap] = part.get(cap, 0) + count * robot.get("count", 1)
    return all(max(part.values()) >= 1000 for part in have.values())


def _write(
    draw: st.DrawFn, world: Drawn, caps: Sequence[str], robots: list[Tree], tasks: list[Tree]
) -> Tree:
    """Return a file with robots and tasks named, or not; the tasks in any order."""
    tree: Tree = {"teamformer": 1, "world": world.tree, "capabilities": list(caps)}
    if now_and_then(draw):
        tree["name"] = draw_names(draw, 1)[0]
    if is_named := now_and_then(draw, 2):
        names = draw_names(draw, len(robots))
        for robot, name in zip(robots, names, strict=True):
            robot["name"] = name
    else:
        names = [f"r{number + 1}" for number in range(len(robots))]
    teams = _teams(draw, names, robots) if now_and_then(draw, 2) else []
    if teams:
        tree["teams"] = teams
    elif now_and_then(draw) and _can_be_numbered(names[-1], names):
        robots[-1]["count"] = pick(draw, (2, 1))
    tree["robots"] = robots
    turned = list(range(len(tasks)))
    if now_and_then(draw, 2):
        turned = turned[::-1] if len(tasks) < 4 else [*turned[2::2], *turned[1::2], 0]
    called = draw_names(draw, len(tasks)) if is_named else []
    task_names = called or [f"t{turned.index(number) + 1}" for number in range(len(tasks))]
    for number, task in enumerate(tasks):
        if "after" in task:
            task["after"] = [task_names[other] for other in task["after"]]
        if "starts" in task:
            task["starts"] = {task_names[other]: gap for other, gap in task["starts"].items()}
        if called:
            task["name"] = called[number]
    return tree | {"tasks": [tasks[number] for number in turned]}


def _can_be_numbered(name: str, names: Sequence[str]) -> bool:
    """Say whether two robots can be called by a name and their number."""
    return len(f"{name}-2") <= LONGEST_TEXT and not {f"{name}-1", f"{name}-2"} & set(names)


def _teams(draw: st.DrawFn, names: Sequence[str], robots: Sequence[Tree]) -> list[list[str]]:
    """Return starting teams of robots that start in the same place."""
    teams: dict[tuple[Any, ...], list[str]] = {}
    for name, robot in zip(names, robots, strict=True):
        if label := pick(draw, (1, 2, 0)):
            teams.setdefault((str(robot["at"]), label), []).append(name)
    return list(teams.values())


def _written(draw: st.DrawFn, counts: Mapping[str, int]) -> list[str] | dict[str, float]:
    """Return counts in thousandths as one would write them."""
    if all(count == 1000 for count in counts.values()) and now_and_then(draw, 2):
        return list(counts)
    return {cap: n // 1000 if n % 1000 == 0 else n / 1000 for cap, n in counts.items()}


def _thousandths(counts: Sequence[str] | Mapping[str, float]) -> dict[str, int]:
    if not isinstance(counts, Mapping):
        return dict.fromkeys(counts, 1000)
    return {cap: round(count * 1000) for cap, count in counts.items()}
