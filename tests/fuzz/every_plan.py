"""Every plan of small missions with optional tasks, shifts, batteries or zones, and of methods.

`PYTHONPATH=tests python tests/fuzz/every_plan.py 30 1` draws so many missions of each kind, and
gives `central` so many seconds for each; `plan` takes what it takes.

Plans are gone through task after task, in the order in which these begin, each by every coalition
of which nobody can be spared: forming takes no time, so nobody has to come along. A plan goes no
further once it is over no sooner than the best one. Those of robots with batteries are gone through
as if nobody had one, which is never slower, and only then carried out with batteries by the plain
rule. Beside batteries there are windows, shifts, optional tasks, a cost, loads or zones.
"""

from __future__ import annotations

import math
import random
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import every_optional_plan
from charged_keys import drawn_with
from charging_missions import charged_mission
from plain_times import able_crews, fitting, walked
from teamformer.base.errors import MissionError
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.plane import Plane
from teamformer.mission.parts.shifts import ALWAYS, fits_all
from teamformer.mission.parts.zones import Zone, has_loads_at_zones
from teamformer.planning.continuous.continuous_mission import pose_mission
from teamformer.planning.continuous.rules import PLANNERS, plan_continuous, warm_up
from teamformer.planning.problem.charged_plans import charged_totals, totals_of
from teamformer.planning.problem.coalition_plan import plan_of_lists
from teamformer.planning.problem.coalition_problem import NOBODY, CoalitionProblem
from teamformer.planning.problem.docks import have_docks
from teamformer.planning.problem.permits import of_robots, rooms_of_permits
from teamformer.planning.problem.rotas import rotas_as_told

ROBOTS, TASKS = 4, 6

ROTAS = (((0.0, 60.0), (75.0, 150.0)), ((30.0, 110.0),), ((0.0, 100.0),), ())
EVERY = 160.0

DOCKS = ((30.0, 0.0), (30.0, 2.0))

IN_ZONES = 0.8
"""Of the tasks."""

NEAR = 1e-5
"""Times are told in whole ticks, of which there are a million and more in all."""

Crews = Sequence[Sequence[tuple[int, ...]]]
Start = Callable[[int, Sequence[int], "Stand", float], float]


@dataclass
class Stand:
    """The latest task of each robot, or NOBODY, and when it is free."""

    place: list[int]
    free: list[float]


def draw_in_shifts(number: int, tasks: int = TASKS) -> Mission:
    """Draw a mission that can be done, whose robots work in shifts that come again."""
    draws = random.Random(number)
    while True:
        try:
            return _drawn(draws, f"shifts {number}", tasks)
        except MissionError:
            continue


def draw_in_zones(number: int, tasks: int = TASKS) -> Mission:
    """Draw a mission that can be done, most of whose tasks are in a zone with little room."""
    draws = random.Random(number)
    while True:
        try:
            mission = _drawn(draws, f"zones {number}", tasks)
            names = tuple(task.name for task in mission.tasks if draws.random() < IN_ZONES)
            zones = (Zone("dock", tasks=names, room=draws.choice([1, 1, 2])),)
            robots = tuple(replace(robot, shifts=(), every=0.0) for robot in mission.robots)
            return replace(mission, robots=robots, zones=zones)
        except MissionError:
            continue


def draw_at_docks(number: int, tasks: int = TASKS - 1) -> Mission:
    """Draw a mission, most of whose tasks are loads, brought to or from a dock with little room."""
    draws = random.Random(number)
    while True:
        try:
            mission = _drawn(draws, f"docks {number}", tasks)
            robots = tuple(replace(robot, shifts=(), every=0.0) for robot in mission.robots)
            moved = tuple(_at_a_dock(draws, task) for task in mission.tasks)
            zones = (Zone("dock", places=DOCKS, room=draws.choice([1, 1, 2])),)
            return replace(mission, robots=robots, tasks=moved, zones=zones)
        except MissionError:
            continue


def _at_a_dock(draws: random.Random, task: Task) -> Task:
    if draws.random() < 0.2:
        return task
    dock = draws.choice(DOCKS)
    at, to = (task.at, dock) if draws.random() < 0.6 else (dock, task.at)
    return replace(task, at=at, to=to, unload=float(draws.randint(15, 60)))


def _drawn(draws: random.Random, name: str, tasks: int) -> Mission:
    caps = ("a", "b", "c")

    def place() -> tuple[float, float]:
        return round(draws.uniform(0, 60), 3), round(draws.uniform(0, 60), 3)

    def robot(number: int) -> Robot:
        can = dict.fromkeys(draws.sample(caps, draws.randint(1, 2)), 1)
        shifts, speed = draws.choice(ROTAS), draws.choice([1, 1, 2])
        every = EVERY if shifts else 0.0
        return Robot(f"r{number}", place(), can, speed=speed, shifts=shifts, every=every)

    robots = [robot(number) for number in range(ROBOTS)]
    able = sorted({cap for one in robots for cap in one.can})
    wanted = [
        Task(
            f"t{number}",
            place(),
            dict.fromkeys(draws.sample(able, min(len(able), draws.randint(1, 2))), 1),
            duration=float(draws.randint(5, 25)),
            after=(f"t{draws.randrange(number)}",) if number and draws.random() < 0.2 else (),
        )
        for number in range(tasks)
    ]
    ends = draws.choice(["home", None])
    return Mission(
        name, Plane(60, 60), caps, tuple(robots), tuple(wanted), time="continuous", ends=ends
    )


def best_on_a_plane(mission: Mission) -> float:
    """Return the least makespan of all plans of a mission on a plane, with shifts and zones."""
    robots, tasks = mission.robots, mission.tasks
    number_of = {task.name: number for number, task in enumerate(tasks)}
    before = [[number_of[name] for name in task.after] for task in tasks]

    def start(task: int, crew: Sequence[int], stand: Stand, earliest: float) -> float:
        came = [_at(mission, r, stand.place[r]) for r in crew]
        there = [
            walked(robots[r], stand.free[r], math.dist(at, tasks[task].at) / robots[r].speed)
            for r, at in zip(crew, came, strict=True)
        ]
        return fitting([robots[r] for r in crew], max(earliest, *there), tasks[task].duration)

    def home(robot: int, place: int, free: float) -> float:
        if mission.ends != "home":
            return free
        way = math.dist(_at(mission, robot, place), robots[robot].at) / robots[robot].speed
        return walked(robots[robot], free, way)

    crews = [least_crews(able_crews(mission, task)) for task in range(len(tasks))]
    durations = [task.duration for task in tasks]
    zones = [(zone.tasks_in(tasks), zone.room) for zone in mission.zones]
    return _least(crews, before, durations, len(robots), start, home, zones)


def _at(mission: Mission, robot: int, place: int) -> tuple[float, float]:
    at = mission.robots[robot].at if place == NOBODY else mission.tasks[place].at
    return float(at[0]), float(at[1])


def best_charged(problem: CoalitionProblem, known: float) -> float:
    """Return what the best plan of a problem with batteries is judged by, in ticks.

    Only plans better than the one `known` are looked for. Nobody gets anywhere sooner because of a
    battery, so plans are gone through as if nobody had one, and are left as soon as that is no
    better. Where there are zones tasks begin in any order, else in that in which they can.
    """
    tasks, robots = range(len(problem.needs)), range(problem.bodies)
    rooms = rooms_of_permits(problem)
    is_any_order = bool(rooms) or have_docks(problem.docks)
    before = [[o for o in row if o != NOBODY] for row in problem.before.tolist()]
    able = [[c for c in _all_crews(len(robots)) if _covers(problem, c, task)] for task in tasks]
    crews = [least_crews(one) for one in able]
    rotas = rotas_as_told(problem.rotas, problem.kind) or [ALWAYS for _ in robots]
    optional = problem.misses.optional.tolist() or [0 for _ in tasks]
    at = problem.origin[: problem.bodies].tolist()
    free = [float(problem.ready[k - len(tasks)]) for k in at]
    made, ends, best = dict[int, tuple[int, ...]](), dict[int, float](), known
    starts = dict[int, float]()

    def go_on(last: float) -> None:
        nonlocal best
        least = totals_of(problem, [ends.get(task, 0.0) for task in tasks], free, 0.0)[0]
        if least >= best:
            return
        if all(task in made or optional[task] for task in tasks):
            order = [*made, *(task for task in tasks if task not in made)]
            plan = plan_of_lists(order, [made.get(task, ()) for task in tasks])
            best = min(best, charged_totals(problem, plan)[0])
        for task in tasks:
            if task in made or any(one not in made for one in before[task]):
                continue
            earliest = max([float(problem.release[task]), *(ends[one] for one in before[task])])
            for room in (one for one in rooms if task in one.tasks):
                ahead = sorted((ends[one] for one in room.tasks if one in made), reverse=True)
                earliest = max([earliest, *(starts[one] for one in room.tasks if one in made)])
                earliest = max([earliest, *ahead[room.room - 1 : room.room]])
            for crew in crews[task]:
                ways = [float(problem.ways[problem.pace[r], at[r], task]) for r in crew]
                there = [rotas[r].walked(free[r], way) for r, way in zip(crew, ways, strict=True)]
                slower = max(int(problem.slower[problem.pace[r], task]) for r in crew)
                takes = int(problem.duration[task]) + slower
                bound = [rotas[r] for r in crew]
                begin = fits_all(bound, max(earliest, *there), takes)
                if (begin < last and not is_any_order) or math.isinf(begin):
                    continue
                was = [(at[r], free[r]) for r in crew]
                made[task], starts[task], ends[task] = crew, begin, begin + takes
                for r in crew:
                    at[r], free[r] = task, begin + takes
                go_on(begin)
                del made[task], ends[task]
                for r, (place, when) in zip(crew, was, strict=True):
                    at[r], free[r] = place, when

    go_on(0.0)
    return best


def _all_crews(robots: int) -> list[tuple[int, ...]]:
    return [tuple(r for r in range(robots) if bits >> r & 1) for bits in range(1, 2**robots)]


def _covers(problem: CoalitionProblem, crew: tuple[int, ...], task: int) -> bool:
    counts, needs = of_robots(problem)
    return bool((counts[list(crew)].sum(axis=0) >= needs[task]).all())


def least_crews(able: Sequence[tuple[int, ...]]) -> list[tuple[int, ...]]:
    """Return those coalitions of which nobody can be spared."""
    return [crew for crew in able if not any(set(other) < set(crew) for other in able)]


def _least(
    crews: Crews,
    before: Sequence[Sequence[int]],
    durations: Sequence[float],
    robots: int,
    start: Start,
    home: Callable[[int, int, float], float],
    zones: Sequence[tuple[Sequence[int], int]] = (),
) -> float:
    """Return the least makespan; `zones` has the tasks of each, and how many go on at once."""
    best, stand = math.inf, Stand([NOBODY] * robots, [0.0] * robots)
    made, ends = dict[int, tuple[int, ...]](), dict[int, float]()

    def has_room(task: int) -> float:
        """Return from when on a task has room that begins after all others that are made."""
        moments = [0.0]
        for inside, room in zones:
            busy = sorted((ends[one] for one in inside if one in ends), reverse=True)
            if task in inside and len(busy) >= room:
                moments.append(busy[room - 1])
        return max(moments)

    def go_on(last: float) -> None:
        nonlocal best
        if len(made) == len(crews):
            over = max(home(r, stand.place[r], stand.free[r]) for r in range(robots))
            best = min(best, over)
            return
        for task, able in enumerate(crews):
            if task in made or any(one not in made for one in before[task]):
                continue
            earliest = max([has_room(task), *(ends[one] for one in before[task])])
            for crew in able:
                begin = start(task, crew, stand, earliest)
                end = begin + durations[task]
                if begin >= last and end < best:
                    was = [(stand.place[r], stand.free[r]) for r in crew]
                    for r in crew:
                        stand.place[r], stand.free[r] = task, end
                    made[task], ends[task] = crew, end
                    go_on(begin)
                    del made[task], ends[task]
                    for r, (place, free) in zip(crew, was, strict=True):
                        stand.place[r], stand.free[r] = place, free

    go_on(0.0)
    return best


def worth_by(mission: Mission, method: str, seconds: float) -> tuple[float, float]:
    """Return what a method's plan misses by weight, and its makespan; infinite without a plan.

    Where robots have batteries it is what the plan is judged by, in ticks, missed tasks included.
    """
    posed = pose_mission(mission)
    if mission.chargers or has_loads_at_zones(mission):
        found = PLANNERS[method](posed.problem, seconds, None)
        return 0.0, math.inf if found is None else found.worth
    made = plan_continuous(posed, method, seconds)
    if made is None:
        return math.inf, math.inf
    return sum(mission.tasks[task].weight for task in made.missed), made.makespan


def best_worth(mission: Mission) -> tuple[float, float]:
    """Return what the best plan of all misses by weight, and its makespan; see `worth_by`."""
    if mission.chargers or has_loads_at_zones(mission):
        return 0.0, best_charged(pose_mission(mission).problem, worth_by(mission, "plan", 0)[1])
    if mission.until is not None:
        return every_optional_plan.best_plan(mission)
    return 0.0, best_on_a_plane(mission)


def draw_charged(keys: str) -> Callable[[int], Mission]:
    """Return what draws missions with batteries and other keys, without forming."""
    return lambda number: replace(drawn_with(keys, number, ROBOTS, TASKS), forming=0.0)


DRAWN: dict[str, Callable[[int], Mission]] = {
    "optional": lambda number: every_optional_plan.draw_mission(number, TASKS, share=0.2),
    "shifts": draw_in_shifts,
    "zones": draw_in_zones,
    "loads at zones": draw_at_docks,
    "charging": lambda number: replace(charged_mission(number, ROBOTS, TASKS), forming=0.0),
    "charging, windows": draw_charged("windows"),
    "charging, shifts": draw_charged("shifts"),
    "charging, optional": draw_charged("optional"),
    "charging, a cost": draw_charged("cost"),
    "charging, loads": draw_charged("loads"),
    "charging, zones": draw_charged("zones"),
}


def main(count: int, seconds: float) -> None:
    """Print for each kind of missions how many plans of methods are as good as the best."""
    for kind, draw in DRAWN.items():
        ratios: dict[str, list[float]] = {"plan": [], "central": []}
        missed = dict.fromkeys(ratios, 0.0)
        for number in range(count):
            mission = draw(number)
            warm_up(mission)
            least, best = best_worth(mission)
            if math.isinf(best):
                continue
            for method, found in ratios.items():
                misses, makespan = worth_by(mission, method, seconds)
                missed[method] += misses - least
                if misses <= least:
                    found.append(makespan / best)
        for method, found in ratios.items():
            good = sum(ratio <= 1 + NEAR for ratio in found)
            print(
                f"{kind}, {method}: {good} of {len(found)} as good, at most {max(found):.4f}; "
                f"{missed[method]:g} too much missed",
                flush=True,
            )


if __name__ == "__main__":
    main(int(sys.argv[1]), float(sys.argv[2]))
