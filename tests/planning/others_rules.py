"""The rules of other people's problems, written from their papers: routes in, times out.

Nothing of ours is used: an instance is its own file, a plan is who visits what in which order.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

Routes = Mapping[str, Sequence[str]]
ROUNDED = 0.02
"""What ways to three places may add up to along a route."""

Way = Callable[[str, str | None, str | None], float]
"""The time of a robot from a task to a task; None is its start, or its end."""


def play(
    routes: Routes,
    way: Way,
    duration: Mapping[str, float],
    before: Sequence[tuple[str, str]] = (),
) -> tuple[float, dict[str, float]]:
    """Return when the last robot is back, and when each task starts.

    A task starts when all robots that have it on their routes are there, and tasks before it have
    ended; they stay until it ends. Routes that wait for one another raise `AssertionError`.
    """
    start: dict[str, float] = {}
    at: dict[str, int] = dict.fromkeys(routes, 0)
    free = dict.fromkeys(routes, 0.0)
    while len(start) < len(duration):
        ready = []
        for task in duration.keys() - start.keys():
            crew = [robot for robot, route in routes.items() if task in route]
            assert crew, f"nobody does {task}"
            is_next = all(routes[robot][at[robot]] == task for robot in crew)
            if is_next and all(one in start for one, two in before if two == task):
                ready.append((task, crew))
        assert ready, "robots wait for one another"
        for task, crew in ready:
            there = [
                free[robot] + way(robot, routes[robot][at[robot] - 1] if at[robot] else None, task)
                for robot in crew
            ]
            earlier = [start[one] + duration[one] for one, two in before if two == task]
            start[task] = max([*there, *earlier])
            for robot in crew:
                at[robot] += 1
                free[robot] = start[task] + duration[task]
    back = [
        free[robot] + way(robot, route[-1] if route else None, None)
        for robot, route in routes.items()
    ]
    return max(back), start


def hetero_mrta_makespan(instance: Mapping[str, Any], routes: Routes) -> float:
    """Return the makespan of routes by the rules of HeteroMRTA (RA-L 2025); skills must suffice."""
    robots, tasks = instance["robots"], instance["tasks"]

    def place(robot: str, task: str | None) -> tuple[float, float]:
        spot = robots[robot[1:]]["pose"] if task is None else tasks[task[1:]]["pos"]
        return spot["x"], spot["y"]

    def way(robot: str, one: str | None, two: str | None) -> float:
        return math.dist(place(robot, one), place(robot, two)) / 0.2

    for key, task in tasks.items():
        crew = [robots[robot[1:]] for robot, route in routes.items() if f"t{key}" in route]
        for skill, needed in task["skillset"].items():
            assert sum(robot["skillset"][skill] for robot in crew) >= needed
    return play(routes, way, {f"t{key}": task["duration"] for key, task in tasks.items()})[0]


def dcmrta_makespan(graph: Mapping[str, Any], needs: Mapping[str, int], routes: Routes) -> float:
    """Return the makespan of routes by the rules of DCMRTA (ICRA 2024); crews must be complete.

    `graph` is that of the one kind of vehicle: ways (fifth of an edge) and durations at nodes.
    """
    depot, end = len(needs), len(needs) + 1
    times = {(e[0], e[1]): e[5] for name, e in graph.items() if name.startswith("edge")}

    def way(robot: str, one: str | None, two: str | None) -> float:
        if one is None and two is None:
            return 0.0
        begin = depot if one is None else int(one[1:])
        return float(times[begin, end if two is None else int(two[1:])])

    for task, needed in needs.items():
        assert sum(task in route for route in routes.values()) >= needed
    return play(routes, way, {task: graph[f"node{task[1:]}"] for task in needs})[0]


def hhcrsp_cost(
    instance: Mapping[str, Any], visits: Mapping[str, Sequence[tuple[str, str, float]]]
) -> float:
    """Return the cost of caregivers' visits (patient, service, start) by HHCRSP's rules.

    As Mankowska and others (2014) and the format of iolab-uniud/hhcrsp have them: everybody is
    able, goes by the distances of the file from the office and back, and is there in time; every
    service is done once, those of a patient by different people with starts so far apart as said.
    """
    patients = {patient["id"]: patient for patient in instance["patients"]}
    row = {name: number for number, name in enumerate(patients, 1)}
    able = {one["id"]: one["abilities"] for one in instance["caregivers"]}
    distance, tardiness, starts = 0.0, [0.0], {}
    for caregiver, route in visits.items():
        at, free = 0, 0.0
        for name, service, start in route:
            patient = patients[name]
            way = instance["distances"][at][row[name]]
            begin, end = patient["time_window"]
            assert service in able[caregiver]
            assert start >= max(begin, free + way) - ROUNDED
            assert (name, service) not in starts
            starts[name, service] = (start, caregiver)
            tardiness.append(max(0.0, start - end))
            asked = {one["service"]: one["duration"] for one in patient["required_caregivers"]}
            at, free, distance = row[name], start + asked[service], distance + way
        distance += instance["distances"][at][0]
    for name, patient in patients.items():
        done = [starts[name, one["service"]] for one in patient["required_caregivers"]]
        if len(done) == 2:
            least, most = patient["synchronization"].get("distance", (0, 0))
            assert done[0][1] != done[1][1]
            assert least - ROUNDED <= done[1][0] - done[0][0] <= most + ROUNDED
    assert len(starts) == sum(len(one["required_caregivers"]) for one in patients.values())
    return float(distance + sum(tardiness) + max(tardiness)) / 3


def sadcher_makespan(instance: Mapping[str, Any], routes: Routes) -> float:
    """Return the makespan of routes by SADCHER's rules: precedence, and everybody to the exit."""
    spots, last = instance["loc"], len(instance["loc"]) - 1

    def way(robot: str, one: str | None, two: str | None) -> float:
        begin = 0 if one is None else int(one[1:])
        return math.dist(spots[begin], spots[last if two is None else int(two[1:])])

    for number, wanted in enumerate(instance["R"], 1):
        crew = [int(robot[1:]) for robot, route in routes.items() if f"t{number}" in route]
        for skill, needed in enumerate(wanted):
            assert sum(instance["Q"][robot][skill] for robot in crew) >= needed
    before = [(f"t{one}", f"t{two}") for one, two in instance["prec"]]
    durations = {f"t{number}": time for number, time in enumerate(instance["T_e"], 1)}
    return play(routes, way, durations, before)[0]
