"""The world that simulated bodies share: robots walk, stand at tasks, do them, and carry loads.

Nothing happens between events, so places are worked out when they are asked for. Who carries a load
goes at the pace of the slowest who do, and stands still if one of them is stuck.
"""

from __future__ import annotations

import heapq
from collections.abc import Iterator, Sequence
from typing import Any

from teamformer.fleet.bodies.batteries import BatteryWorld
from teamformer.fleet.bodies.body import Command, Report
from teamformer.fleet.bodies.journey import Journey
from teamformer.fleet.bodies.simulated import (
    CARRIED,
    SERVICE,
    UNLOADING,
    Done,
    WorkUnderWay,
)
from teamformer.fleet.bodies.walking import NEVER, Lifted
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.messages import TaskFact
from teamformer.mission.model import Mission
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.places import sight_of
from teamformer.mission.parts.roads import Roads
from teamformer.world.continuous.events import Event, Passed
from teamformer.world.continuous.ways import way_together
from teamformer.world.rules.constants import NOBODY

OPENS, OFF, CLOSE, BORDER = -1.0, -2.0, -3.0, -4.0
"""Stand at the end of events for the begin of a task's window, that it is called off, that the
mission is over, and that a shift begins or ends of the robot which stands in place of the task."""

AFTER_ALL = 1 << 63
"""Stands for the task of what comes after all that happens to tasks at the same moment."""


class FleetWorld(BatteryWorld):
    """All robots and tasks; `advance` lets time pass, which must never run backwards.

    `truth` is the mission as it really is, where something of it is uncertain.
    """

    def __init__(self, mission: FleetMission, truth: Mission | None = None) -> None:
        super().__init__(mission, truth)
        facts = mission.tasks if truth is None else mission.facts_of(truth)[: len(mission.tasks)]
        self.tasks: dict[int, TaskFact] = {task.key: task for task in facts}
        self.done: dict[int, Done] = {}
        self.over: set[int] = set()  # what is done, called off or missed
        self.missed: set[int] = set()  # what was not over when the mission was
        self._lies: dict[int, Place] = {}  # loads that were moved, by task
        self._ways_of_loads: dict[int, Journey] = {}  # of those that are carried
        self._services: dict[int, WorkUnderWay] = {}  # by task
        self._events += [(at, NOBODY, key, OPENS) for key, at in mission.opens.items()]
        self._events += [(at, NOBODY, key, OFF) for key, at in mission.off_at.items()]
        if mission.until < NEVER:
            self._events.append((mission.until, NOBODY, AFTER_ALL, CLOSE))
        heapq.heapify(self._events)
        for robot in range(mission.robots):
            self._put_border(robot, 0.0)

    def add_task(self, task: TaskFact) -> None:
        """Let there be another task."""
        self.tasks.setdefault(task.key, task)
        if self.now >= self.mission.until and task.key not in self.over:
            self._miss(task.key)

    def call_off(self, key: int) -> None:
        """Let a task be called off: what comes after it may begin; who does not know may do it."""
        self._end(key)

    def _end(self, key: int) -> None:
        self.over.add(key)
        for other, before in self.mission.before.items():
            if key in before:
                self._look_at_services(other)

    def is_served(self, key: int) -> bool:
        """Say whether robots are at work on a task."""
        return key in self._services

    @property
    def is_over(self) -> bool:
        """Say whether every task is done or called off."""
        return self.tasks.keys() <= self.over

    @property
    def next_event(self) -> float:
        """Return when a robot arrives, a task is done or a battery is full next; inf for never."""
        return min(self._events[0][0] if self._events else NEVER, self.next_of_batteries)

    def advance(self, now: float) -> set[int]:
        """Let time pass; return the robots that sense something new."""
        touched: set[int] = set()
        while (due := self.next_event) <= now:
            self.pass_to(due, touched)
            if self._events and self._events[0][0] <= due:
                self._happen(touched)
            self.plug(touched)
        self.pass_to(now, touched)
        return touched

    def _happen(self, touched: set[int]) -> None:
        """Let the next event happen."""
        _, robot, task, stamp = heapq.heappop(self._events)
        if robot != NOBODY:
            if self.robots[robot].journey.end == stamp:
                touched.add(robot)
                self._look_at_services(self.robots[robot].command.task)
        elif stamp == OPENS:
            self._look_at_services(task)
        elif stamp == OFF:
            self.call_off(task)
        elif stamp == CLOSE:
            self._close(touched)
        elif stamp == BORDER:
            self._pass_border(task, touched)
        elif task in self._services and self._services[task].end == stamp:
            self._go_on(task, touched)

    def _close(self, touched: set[int]) -> None:
        """Let all be missed that is not over, and break off what is under way."""
        for key in self.tasks.keys() - self.over:
            self._miss(key)
        for robot, body in enumerate(self.robots):
            if body.carries != NOBODY:
                self._let_go(robot, touched)
        for key in list(self._services):
            self._look_at_services(key)

    def _put_border(self, robot: int, after: float) -> None:
        """Have it noticed when the next shift of a robot begins or ends."""
        step = self.mission.step
        border = self.mission.source.robots[robot].rota.next_border(after / step)
        if border is not None:
            heapq.heappush(self._events, (border[0] * step, NOBODY, robot, BORDER))

    def _pass_border(self, robot: int, touched: set[int]) -> None:
        """Let a shift begin, or break off what a robot does whose shift ends."""
        body, key = self.robots[robot], self.robots[robot].command.task
        if body.carries != NOBODY:
            self._let_go(robot, touched)
        service = self._services.get(key)
        is_here = key in self.tasks and self.mission.is_same_place(
            *self.place(robot), *self.place_of(key)
        )
        if service is not None and service.team == body.command.team and is_here:
            del self._services[key]
            self._tell("broken", key, ())
        self._look_at_services(key)
        self._put_border(robot, self.now)
        touched.add(robot)

    def _miss(self, key: int) -> None:
        self.missed.add(key)
        self.over.add(key)

    def command(self, robot: int, command: Command) -> set[int]:
        """Let a robot obey from now on; return the robots that sense something new."""
        body, touched = self.robots[robot], set[int]()
        if body.is_dead or command == body.command:
            return touched
        old, body.command = body.command, command
        if body.carries != NOBODY and not self._is_at_work(robot, body.carries):
            self._let_go(robot, touched)
        if (command.leg, command.place) != (old.leg, old.place) and body.carries == NOBODY:
            self.walk(robot)
            touched.add(robot)
        for task in {old.task, command.task}:
            self._look_at_services(task)
        self.plug(touched)
        return touched

    def report(self, robot: int) -> Report:
        """Return what a robot senses now."""
        is_dry = self.robots[robot].is_dry
        return self._sensed(robot)._replace(charge=self.charge(robot), is_unfit=is_dry)

    def _sensed(self, robot: int) -> Report:
        """Return what a robot senses around it."""
        body = self.robots[robot]
        x, y = self.place(robot)
        command = body.command
        task, number = self.tasks.get(command.task), 1 + round(1000 * self.now)  # milliseconds
        if task is None:
            return Report(x, y, command.leg, number=number)
        at, service = self.place_of(task.key), self._services.get(task.key)
        is_here = self.mission.is_same_place(x, y, *at)
        is_done = is_here and task.key in self.done
        is_busy = is_here and service is not None and service.team != command.team
        report = Report(x, y, command.leg, is_done, is_busy, number)
        if is_here and task.key in self.mission.unsure:
            report = report._replace(needs=task.needs)
        if task.key in self.mission.hidden:
            radius = self.mission.source.finding_radius
            is_seen = is_here or sight_of(self._map, (x, y), at) <= radius
            return report._replace(load=at if is_seen else None, is_gone=not is_here)
        if task.to is None:
            return report
        if body.carries == task.key:
            return report._replace(carries=True)
        if task.key in self._ways_of_loads:  # others have it
            return report._replace(is_gone=True)
        is_seen = is_here or self._sees(robot, at)
        return report._replace(load=at if is_seen else None, is_gone=not is_here)

    def _sees(self, robot: int, load: Place) -> bool:
        """Say whether a robot sees a load; on roads also where it has just set out."""
        journey = self.robots[robot].journey
        has_left = journey.way[journey.passed(self.now)].place == load
        return has_left or self.mission.apart(self.place(robot), load) <= self.mission.sight

    def place_of(self, key: int) -> Place:
        """Return where a task is, or where its load is now."""
        if key in self._ways_of_loads:
            return self._ways_of_loads[key].place(self.now, self._map)
        return self._lies.get(key, (self.tasks[key].x, self.tasks[key].y))

    def kill(self, robot: int) -> set[int]:
        """Let a robot break down where it is."""
        return self._set_still(robot, is_dead=True)

    def revive(self, robot: int) -> None:
        """Let a robot start anew where it broke down."""
        body = self.robots[robot]
        body.is_dead, body.command = False, Command()

    def hold_fast(self, robot: int) -> set[int]:
        """Let a robot be unable to move."""
        return self._set_still(robot, is_dead=self.robots[robot].is_dead, is_stuck=True)

    def let_go(self, robot: int) -> None:
        """Let a robot move again, on to where it was told to go."""
        self.robots[robot].is_stuck = self.robots[robot].is_dry
        if self.robots[robot].carries != NOBODY:
            self._carry(self.robots[robot].carries)
        elif not self.robots[robot].is_dead:
            self.walk(robot)

    def at_work(self, key: int) -> Iterator[int]:
        """Return the robots that stand at a task or carry its load, alive and told to serve it."""
        at = self.place_of(key)
        is_up = key in self._ways_of_loads
        for robot, body in enumerate(self.robots):
            if not self._is_at_work(robot, key):
                continue
            is_at_it = self.mission.is_same_place(*self.place(robot), *at)
            if body.carries == key if is_up else is_at_it:
                yield robot

    def _is_at_work(self, robot: int, key: int) -> bool:
        """Say whether a robot serves a task, and has a way on with its load, if it has one."""
        body, to = self.robots[robot], self.tasks[key].to
        is_told = body.command.serve and body.command.task == key
        is_told = is_told and not (body.is_dead or body.is_dry)
        is_told = is_told and self.mission.is_at_work(robot, self.now)
        return is_told and (to is None or self.mission.leads(robot, self.place_of(key), to))

    def _set_still(self, robot: int, is_dead: bool, is_stuck: bool = False) -> set[int]:
        body = self.robots[robot]
        touched = set[int]()
        body.is_dead, body.is_stuck = is_dead, body.is_stuck or is_stuck
        self.stop(robot)
        if body.carries != NOBODY and (is_dead or body.is_dry):
            self._let_go(robot, touched)
        elif body.carries != NOBODY:
            self._carry(body.carries)
        self._look_at_services(body.command.task)
        self.plug(touched)
        return touched

    def at_carry(self, key: int) -> list[int]:
        """Return those who carry a load."""
        return [robot for robot, body in enumerate(self.robots) if body.carries == key]

    def is_at_task(self, robot: int, key: int) -> bool:
        """Say whether a robot stands at a task that is not over."""
        is_open = key in self.tasks and key not in self.over
        return is_open and self.mission.is_same_place(*self.place(robot), *self.place_of(key))

    def is_in_team(self, robot: int, key: int) -> bool:
        """Say whether a robot is of the team that is at work on a task."""
        return key in self._services and robot in self.at_work(key)

    def _carry(self, key: int) -> None:
        """Have those who carry a load go on with it from where it is."""
        who, here, to = list(self.at_work(key)), self.place_of(key), self.tasks[key].to
        assert to is not None
        if here == to or self._services[key].part == UNLOADING:
            return
        way = self._ways_of_loads[key].stop(self.now, self._map)
        if not any(self.robots[robot].is_stuck for robot in who):
            begin = way.beginning(self.now, self._map)
            movers = [(self.mission.source.robots[r].moves, self.mission.paces[r]) for r in who]
            stages = way_together(self.mission.ways, movers, begin[-1].place, to)
            way = Journey((*begin, *self.passing(self._still_with_load, who, begin[-1].at, stages)))
        self._ways_of_loads[key] = way
        for robot in who:  # in a plane each a little way from the load
            at = Passed(way.way[0].at, self.place(robot))
            is_road = isinstance(self._map, Roads)
            self.set_out(robot, way if is_road else Journey((at, *way.way[1:])))
        team = self.robots[who[0]].command.team
        self._begin(key, WorkUnderWay(team, way.end, CARRIED))
        if way.end < NEVER:
            self._tell("lift", key, who, until=way.end, way=way.way)

    def _let_go(self, robot: int, touched: set[int]) -> None:
        """Let a robot carry no more: the others go on if they can, or set the load down."""
        key, body = self.robots[robot].carries, self.robots[robot]
        body.carries = NOBODY
        self.stop(robot)
        who = self.at_carry(key)
        touched.update((robot, *who))
        if self.mission.covers(who, self.tasks[key].needs):
            self._carry(key)
            return
        way = self._ways_of_loads.pop(key)
        is_road, passed = isinstance(self._map, Roads), way.way[way.passed(self.now)].place
        self._lies[key] = passed if is_road else way.place(self.now, self._map)
        del self._services[key]
        for other in who:
            self.robots[other].carries = NOBODY
            self.stop(other)
        self.moves.append(Lifted(self.now, key, (), self._lies[key]))
        self._tell("broken", key, (robot, *who))

    def _begin(self, key: int, service: WorkUnderWay) -> None:
        """Begin a part of a service."""
        self._services[key] = service
        if service.end < NEVER:
            heapq.heappush(self._events, (service.end, NOBODY, key, service.end))

    def _look_at_services(self, key: int) -> None:
        """Begin or break off the service of a task, by who is at work on it now."""
        if key not in self.tasks or key in self.done or key in self._ways_of_loads:
            return
        teams: dict[int, list[int]] = {}
        for robot in self.at_work(key):
            teams.setdefault(self.robots[robot].command.team, []).append(robot)
        needs = self.tasks[key].needs
        able = [team for team, who in sorted(teams.items()) if self.mission.covers(who, needs)]
        able = [] if key in self.missed else able
        going = self._services.get(key)
        if going is not None and going.team not in able:
            del self._services[key]
            self._tell("broken", key, ())
            going = None
        if going is None and able and self.mission.may_begin(key, self.over, self.now):
            service = WorkUnderWay(able[0], self.now + self.tasks[key].duration)
            self._begin(key, service)
            self._tell("serve", key, teams[able[0]], until=service.end)

    def _go_on(self, key: int, touched: set[int]) -> None:
        """Go on with what follows a part of a service."""
        task, (team, _, part) = self.tasks[key], self._services[key]
        if part == SERVICE and task.to is not None:
            self._take_up(key, touched)
        if task.to is None or part == UNLOADING:
            self._finish(key, touched)
        elif self.place_of(key) == task.to:
            end = self.now + task.unload
            self._begin(key, WorkUnderWay(team, end, UNLOADING))
            self._tell("unload", key, list(self.at_work(key)), until=end)

    def _take_up(self, key: int, touched: set[int]) -> None:
        """Let those who have taken up a load set out with it; all who are there sense it."""
        team, here = self._services[key].team, self.place_of(key)
        who = tuple(r for r in self.at_work(key) if self.robots[r].command.team == team)
        self._touch(here, touched)
        self._ways_of_loads[key] = Journey((Passed(self.now, here),))
        for robot in who:
            self.robots[robot].carries = key
        self.moves.append(Lifted(self.now, key, who, here))
        self._carry(key)

    def _finish(self, key: int, touched: set[int]) -> None:
        team, place = self._services.pop(key).team, self.place_of(key)
        who = tuple(r for r in self.at_work(key) if self.robots[r].command.team == team)
        self.done[key] = Done(self.now, key, team, who)
        self._tell("done", key, who)
        self._end(key)
        if self._ways_of_loads.pop(key, None) is not None:
            self._lies[key] = place
            for robot in who:
                self.robots[robot].carries = NOBODY
        self._touch(place, touched)

    def _tell(self, kind: str, key: int, robots: Sequence[int], **said: Any) -> None:
        """Write down an event of the service of a task."""
        event = Event(self.now, kind, tuple(sorted(robots)), key, place=self.place_of(key))
        self.moves.append(event._replace(**said))

    def _touch(self, place: Place, touched: set[int]) -> None:
        """Let all sense something new who are at a place."""
        here = (self.mission.is_same_place(*self.place(r), *place) for r in range(len(self.robots)))
        touched.update(robot for robot, is_here in enumerate(here) if is_here)
