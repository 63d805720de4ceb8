"""When a plan in continuous time does what, by docs/reference/mission/time.md: routes to times.

Nothing is shared with the planner. All that has to wait for something is made to wait a little
longer, again and again, until nothing changes any more.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from teamformer.mission.model import Mission, Robot
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.roads import Roads

TURNS = 60
"""How often shifts come again that are looked at."""

Routes = Sequence[Sequence[int]]
"""The tasks of each robot, in its order."""


@dataclass(frozen=True)
class Times:
    """When tasks start, when each robot is back, and what of it costs something."""

    start: list[float]
    takes: list[float]  # how long each task does
    back: list[float]
    travel: float
    late: dict[int, float]
    cost: float | None

    @property
    def makespan(self) -> float:
        """Return when the last robot is back."""
        return max(self.back)


class Ways:
    """How long robots take from place to place."""

    def __init__(self, mission: Mission) -> None:
        self._world = mission.world
        self._fields: dict[Place, dict[Place, int]] = {}

    def time(self, robot: Robot, here: Place, there: Place) -> float:
        """Return how long a robot takes for a way; infinity where there is none."""
        if isinstance(self._world, Roads):
            return self._by_road(robot.moves, int(here[0]), int(there[0])) / robot.speed
        if not hasattr(self._world, "neighbours"):
            return math.dist(here, there) / robot.speed
        if robot.flies:
            return (abs(here[0] - there[0]) + abs(here[1] - there[1])) / robot.speed
        if there not in self._fields:
            self._fields[there] = self._field(there)
        return self._fields[there].get(here, math.inf) / robot.speed

    def _by_road(self, moves: str, here: int, there: int) -> float:
        """Return the time of the direct way or, where there is none, of the quickest walk."""
        times = self._world.times[moves]
        if times[here][there] < math.inf:
            return times[here][there]
        best = [0.0 if place == here else math.inf for place in range(len(times))]
        for _ in times:
            for one, row in enumerate(times):
                best = [min(was, best[one] + time) for was, time in zip(best, row, strict=True)]
        return best[there]

    def _field(self, there: Place) -> dict[Place, int]:
        field, frontier = {there: 0}, [there]
        for place in frontier:
            for beside in self._world.neighbours(place):
                if beside not in field:
                    field[beside] = field[place] + 1
                    frontier.append(beside)
        return field


def shifts_of(robot: Robot) -> list[tuple[float, float]]:
    """Return when a robot works, for as long as anybody looks ahead."""
    if not robot.shifts:
        return [(0.0, math.inf)]
    turns = range(TURNS if robot.every else 1)
    return [(a + n * robot.every, b + n * robot.every) for n in turns for a, b in robot.shifts]


def walked(robot: Robot, begin: float, spent: float) -> float:
    """Return when a robot has walked so long, which pauses outside its shifts."""
    if spent == 0 or math.isinf(spent):
        return begin + spent
    for opens, closes in shifts_of(robot):
        start = max(begin, opens)
        if start + spent <= closes + 1e-9 * max(1.0, closes):
            return start + spent
        spent -= max(0.0, closes - start)
    return math.inf


def fitting(crew: Sequence[Robot], earliest: float, takes: float) -> float:
    """Return the first moment from which something is within one shift of each of a crew."""
    if math.isinf(earliest + takes):
        return math.inf
    opening = {a for robot in crew for a, _ in shifts_of(robot) if a > earliest}
    for start in sorted({earliest, *opening}):
        in_time = [
            any(a <= start and start + takes <= b + 1e-9 * max(1.0, b) for a, b in shifts_of(robot))
            for robot in crew
        ]
        if all(in_time):
            return start
    return math.inf


def _end_of(mission: Mission, task: int) -> Place:
    """Return where robots are once they have done a task."""
    wanted = mission.tasks[task]
    return wanted.at if wanted.to is None else wanted.to


def _takes(mission: Mission, task: int, crew: Sequence[int], ways: Ways) -> float:
    """Return how long robots take for a task: a load goes as fast as its slowest carrier."""
    wanted = mission.tasks[task]
    if wanted.to is None:
        return wanted.duration
    carried = [ways.time(mission.robots[robot], wanted.at, wanted.to) for robot in crew]
    return wanted.duration + max(carried, default=0.0) + wanted.unload


def times_of(
    mission: Mission, routes: Routes, ways: Ways, order: Sequence[int] = ()
) -> Times | None:
    """Return the times of a plan; None if robots wait for one another for ever.

    Tasks enter zones in the order that is given.
    """
    tasks, robots = mission.tasks, mission.robots
    number_of = {task.name: number for number, task in enumerate(tasks)}
    crews = [[r for r, route in enumerate(routes) if k in route] for k in range(len(tasks))]
    takes = [_takes(mission, k, crew, ways) for k, crew in enumerate(crews)]
    begun = [max(float(t.appears), t.between[0] if t.between else 0.0) for t in tasks]
    last = [[None, *route] for route in routes]
    came: list[tuple[list[tuple[Robot, int | None, float]], float]] = []  # by task; and forming
    least: list[tuple[int | None, int, float]] = []  # (k, l, t): l starts t after k does, or t
    for k, crew in enumerate(crews):
        before_it = {r: last[r][routes[r].index(k)] for r in crew}
        at = {r: robots[r].at if o is None else _end_of(mission, o) for r, o in before_it.items()}
        legs = [
            (robots[r], one, ways.time(robots[r], at[r], tasks[k].at))
            for r, one in before_it.items()
        ]
        came.append((legs, mission.forming if len(set(at.values())) > 1 else 0.0))
        least += [(number_of[o], k, takes[number_of[o]]) for o in tasks[k].after]
        for name, (soonest, latest) in tasks[k].starts.items():
            least += [(number_of[name], k, soonest), (k, number_of[name], -latest)]
    for _ in range(len(tasks) + 1):
        before = list(begun)
        for one, k, wait in least:
            begun[k] = max(begun[k], wait + (0.0 if one is None else begun[one]))
        for k, (legs, forming) in enumerate(came):
            ends = [0.0 if one is None else begun[one] + takes[one] for _, one, _ in legs]
            there = max(walked(leg[0], end, leg[2]) for leg, end in zip(legs, ends, strict=True))
            crew_of_k = [robot for robot, _, _ in legs]
            if forming:
                there = fitting(crew_of_k, there, forming) + forming
            begun[k] = max(begun[k], there, _has_room(mission, order, k, begun, takes))
            begun[k] = fitting(crew_of_k, begun[k], takes[k])
        if begun == before:
            return _told(mission, routes, ways, begun, takes)
    return None


def _has_room(
    mission: Mission, order: Sequence[int], task: int, begun: list[float], takes: list[float]
) -> float:
    """Return from when on a task may enter its zones behind those that are before it there."""
    moments = [0.0]
    for zone in mission.zones:
        inside = zone.tasks_in(mission.tasks)
        if task not in inside or zone.room >= len(inside):
            continue
        ahead = [one for one in order[: order.index(task)] if one in inside]
        ends = sorted(begun[one] + takes[one] for one in ahead)
        moments += [begun[one] for one in ahead] + ends[: max(0, len(ends) - zone.room + 1)]
    return max(moments)


def _told(
    mission: Mission, routes: Routes, ways: Ways, start: list[float], takes: list[float]
) -> Times:
    tasks = mission.tasks
    back, travel = [], 0.0
    for robot, route in zip(mission.robots, routes, strict=True):
        at, free = robot.at, 0.0
        for k in route:
            travel += ways.time(robot, at, tasks[k].at)
            at, free = _end_of(mission, k), start[k] + takes[k]
        end = robot.at if mission.ends == "home" else mission.ends or at
        home = ways.time(robot, at, end)
        travel, back = travel + home, [*back, walked(robot, free, home)]
    over = {k: start[k] + takes[k] - t.between[1] for k, t in enumerate(tasks) if t.between}
    late = {k: by for k, by in over.items() if by > 1e-9}
    parts = {
        "makespan": max(back),
        "travel": travel,
        "tardiness": sum(tasks[k].weight * by for k, by in late.items()),
        "max_tardiness": max(late.values(), default=0.0),
        "completion": sum(t.weight * (start[k] + takes[k]) for k, t in enumerate(tasks)),
    }
    cost = None
    if mission.cost is not None:
        weighed = sum(weight * parts[name] for name, weight in mission.cost.items())
        cost = weighed / sum(mission.cost.values())
    return Times(start, takes, back, travel, late, cost)


def all_plans(mission: Mission, ways: Ways) -> Iterator[Times]:
    """Return every plan of a tiny mission: all orders, and all coalitions that are able.

    In an order no task is before one that it is `after`. Else, where neither tasks nor ways take
    time, robots could come to it from what waits for it.
    """
    tasks, robots = mission.tasks, range(len(mission.robots))
    number_of = {task.name: number for number, task in enumerate(tasks)}
    pairs = [(number_of[name], k) for k, task in enumerate(tasks) for name in task.after]
    orders = [
        order
        for order in itertools.permutations(range(len(tasks)))
        if all(order.index(first) < order.index(then) for first, then in pairs)
    ]
    able = (able_crews(mission, task) for task in range(len(tasks)))
    for crews in itertools.product(*able):
        if not _are_apart(mission, crews):
            continue
        for order in orders:
            routes = [[k for k in order if r in crews[k]] for r in robots]
            times = times_of(mission, routes, ways, order)
            if times is not None and times.makespan < math.inf:
                yield times


def able_crews(mission: Mission, task: int) -> list[tuple[int, ...]]:
    """Return all coalitions that can do a task, those with robots to spare, too."""
    robots = range(len(mission.robots))
    crews = [c for n in robots for c in itertools.combinations(robots, n + 1)]
    return [c for c in crews if _is_able(mission, c, mission.tasks[task].needs)]


def _is_able(mission: Mission, crew: Sequence[int], needs: object) -> bool:
    return all(
        round(sum(mission.robots[r].can.get(cap, 0) for r in crew) * 1000) >= round(n * 1000)
        for cap, n in needs.items()
    )


def _are_apart(mission: Mission, crews: Sequence[Sequence[int]]) -> bool:
    """Say whether tasks whose starts are linked with one another are done by different robots."""
    number_of = {task.name: number for number, task in enumerate(mission.tasks)}
    pairs = [(k, number_of[o]) for k, task in enumerate(mission.tasks) for o in task.starts]
    return not any(set(crews[a]) & set(crews[b]) for a, b in pairs)
