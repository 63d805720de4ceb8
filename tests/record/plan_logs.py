"""Records of plans that are carried out undisturbed, made of nothing but the plans' own times.

It is what a world in continuous time has to tell where nothing happens from outside.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from teamformer.mission.checks.windows import release_of
from teamformer.mission.model import Mission
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.roads import Roads
from teamformer.planning.problem.routes import MissionPlan, Stop
from teamformer.record.record import Ending, Record
from teamformer.world.continuous.events import Event, Passed, PlanMade, PlannedTask
from teamformer.world.rules.constants import NOBODY

NEAR = 1e-9


@dataclass
class Log:
    """Events as they come, each with the number of the one that caused it."""

    events: list[Event] = field(default_factory=list)

    def tell(self, event: Event) -> int:
        self.events.append(event)
        return len(self.events) - 1

    def in_order(self) -> tuple[Event, ...]:
        """Return the events in the order of time; those of one moment as they were told."""
        order = sorted(range(len(self.events)), key=lambda n: self.events[n].at)
        number = {old: new for new, old in enumerate(order)} | {NOBODY: NOBODY}
        return tuple(self.events[n]._replace(cause=number[self.events[n].cause]) for n in order)


def way(
    mission: Mission, robot: int, begin: float, end: float, one: Place, other: Place
) -> tuple[Passed, ...]:
    """Return a way: along the cells of a grid without walls, or of roads by the places between."""
    world = mission.world
    if isinstance(world, Roads):
        places = between(world, mission.robots[robot].moves, int(one[0]), int(other[0]))
        rows = world.ways[mission.robots[robot].moves]
        whole = rows[places[0]][places[-1]] or 1.0
        return tuple(
            Passed(begin + (end - begin) * rows[places[0]][place] / whole, (place, 0))
            for place in places
        )
    return (Passed(begin, one), Passed(end, other)) if one != other else (Passed(begin, one),)


def between(world: Roads, mover: str, one: int, other: int) -> list[int]:
    """Return the places that the quickest way passes, both ends included."""
    rows, places = world.ways[mover], [one]
    while places[-1] != other:
        here = places[-1]
        on_way = [
            k
            for k in range(len(rows))
            if k != here and abs(rows[here][k] + rows[k][other] - rows[here][other]) < NEAR
        ]
        places.append(min(on_way, key=lambda k: (rows[here][k], k)) if on_way else other)
    return places


def record_of(mission: Mission, plan: MissionPlan) -> Record:
    """Return the record of a plan that is carried out as it was made."""
    log = Log()
    visits: dict[int, list[tuple[int, Stop]]] = {}
    for route in plan.routes:
        for stop in route.stops:
            visits.setdefault(stop.task, []).append((route.robot, stop))
    ends = {task: rows[0][1].end for task, rows in visits.items()}
    rows = tuple(
        PlannedTask(task, robots, ends[task])
        for task, robots in zip(plan.order, plan.coalitions, strict=True)
    )
    made = log.tell(Event(0, "plan", plan=PlanMade(("start",), rows)))
    at = [robot.at for robot in mission.robots]
    free, because = [0.0] * len(at), [made] * len(at)
    done: dict[int, int] = {}
    for task in plan.order:
        wanted = mission.tasks[task]
        team = tuple(robot for robot, _ in visits[task])
        came = {}
        for robot, stop in visits[task]:
            passed = way(mission, robot, free[robot], stop.arrive, at[robot], wanted.at)
            walk = Event(
                free[robot], "walk", (robot,), task, until=stop.arrive, way=passed,
                cause=because[robot],
            )  # fmt: skip
            came[robot] = log.tell(
                Event(stop.arrive, "arrive", (robot,), task, wanted.at, cause=log.tell(walk))
            )
        start, end = visits[task][0][1].start, visits[task][0][1].end
        begun = begins(mission, log, task, team, start, came, done)
        end_of = log.tell(
            Event(
                start,
                "serve",
                team,
                task,
                wanted.at,
                end,
                cause=begun,
            )
        )
        place = wanted.at
        if wanted.to is not None:
            up, down = start + wanted.duration, end - wanted.unload
            carried = way(mission, team[0], up, down, wanted.at, wanted.to)
            end_of = log.tell(Event(up, "lift", team, task, wanted.at, down, carried, end_of))
            place = wanted.to
            end_of = log.tell(Event(down, "unload", team, task, place, end, cause=end_of))
        done[task] = log.tell(Event(end, "done", team, task, place, cause=end_of))
        for robot in team:
            at[robot], free[robot], because[robot] = place, end, done[task]
    for route in plan.routes:
        goal = mission.robots[route.robot].at if mission.ends == "home" else mission.ends
        if goal is None or isinstance(goal, str) or (at[route.robot] == goal):
            continue
        passed = way(mission, route.robot, free[route.robot], route.back, at[route.robot], goal)
        walk = Event(
            free[route.robot], "walk", (route.robot,), until=route.back, way=passed,
            cause=because[route.robot],
        )  # fmt: skip
        log.tell(Event(route.back, "arrive", (route.robot,), place=goal, cause=log.tell(walk)))
    last_end = max(
        (n for n, event in enumerate(log.events) if event.kind in ("done", "arrive")),
        key=lambda n: (log.events[n].at, -n),
        default=made,
    )
    log.tell(Event(log.events[last_end].at, "over", cause=last_end, status="completed"))
    names = {mission.tasks[task].name: by for task, by in plan.late.items()}
    end = Ending("completed", plan.makespan, tasks_done=len(done), cost=plan.cost, late=names)
    return Record(
        mission, "plan", 0, end=end, events=log.in_order(), lower_bound=plan.bound or None
    )


def begins(
    mission: Mission,
    log: Log,
    task: int,
    team: tuple[int, ...],
    start: float,
    came: dict[int, int],
    done: dict[int, int],
) -> int:
    """Tell of what a task begins with: its team forms, or it opens; return what that hung on."""
    near = NEAR * max(1.0, start)
    last = max(came.values(), key=lambda n: log.events[n].at)
    arrived = log.events[last].at
    place = mission.tasks[task].at
    formed = last
    if mission.forming and start >= arrived + mission.forming - near and len(team) > 1:
        until = arrived + mission.forming
        form = log.tell(Event(arrived, "form", team, task, place, until, cause=last))
        formed = log.tell(Event(until, "formed", team, task, place, cause=form))
    if log.events[formed].at >= start - near:
        return formed
    for name in mission.tasks[task].after:
        before = next(n for n, other in enumerate(mission.tasks) if other.name == name)
        if abs(log.events[done[before]].at - start) <= near:
            return done[before]
    if abs(release_of(mission.tasks[task]) - start) <= near:
        return log.tell(Event(start, "opens", task=task))
    return formed
