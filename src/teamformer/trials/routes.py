"""Where robots went in a recorded trial: their stops, read off the record."""

from __future__ import annotations

from teamformer.planning.problem.routes import Route, Stop
from teamformer.record.record import Record
from teamformer.record.teams import Teams
from teamformer.world.rules.constants import NOBODY


def routes_of(record: Record) -> tuple[Route, ...]:
    """Return each robot's stops, in steps or in the mission's unit of time.

    A robot arrives when it comes to the task's place. In steps work begins when it has the whole
    team there, as many steps before the end, or before the load is up, as the task takes.
    """
    return _routes_by_events(record) if record.is_continuous else _routes_by_steps(record)


def _routes_by_events(record: Record) -> tuple[Route, ...]:
    robots = range(len(record.mission.robots))
    came, begun, back = [0.0 for _ in robots], dict[int, float](), [0.0 for _ in robots]
    stops: list[list[Stop]] = [[] for _ in robots]
    for event in record.events:
        if event.kind == "serve":
            begun[event.task] = event.at
        for robot in event.robots:
            if event.kind == "arrive":
                came[robot] = event.at
                back[robot] = event.at if event.task == NOBODY else back[robot]
            elif event.kind == "done":
                stops[robot].append(Stop(event.task, came[robot], begun[event.task], event.at))
                back[robot] = event.at
    return tuple(Route(robot, tuple(stops[robot]), back[robot]) for robot in robots)


def _routes_by_steps(record: Record) -> tuple[Route, ...]:
    teams = Teams(record.mission.robots, record.start)
    robots = range(len(record.mission.robots))
    place, since = [teams.place(robot) for robot in robots], [0 for _ in robots]
    stops: list[list[Stop]] = [[] for _ in robots]
    taken: dict[int, int] = {}  # load -> the step in which it was last taken up
    for number, step in enumerate(record.steps, 1):
        taken |= dict.fromkeys((task for task, _ in step.taken), number)
        teams.follow(step)
        for robot in robots:
            if teams.place(robot) != place[robot] or robot in step.back:
                place[robot], since[robot] = teams.place(robot), number
        for task, slot in step.done:
            start = taken.get(task, number) - record.true_mission.tasks[task].duration
            for robot in teams.doers(slot):
                earlier = stops[robot][-1].end if stops[robot] else 0
                came = since[robot] if task not in taken else start
                arrive = min(start, max(earlier, came))
                stops[robot].append(Stop(task, arrive, start, number))
    return tuple(
        Route(robot, tuple(made), made[-1].end if made else 0) for robot, made in enumerate(stops)
    )
