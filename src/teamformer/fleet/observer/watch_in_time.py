"""What an onlooker makes of a fleet in continuous time: a record of events, as robots tell of them.

Once a unit of time it is written down what has changed. Robots say where they are about once a
second; how they go on to their tasks is as their ways lead.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.messages import HERE, SERVE, Terms, Word
from teamformer.fleet.observer.watch import Watch
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.plane import Plane
from teamformer.mission.parts.roads import Roads
from teamformer.record.record import Record, Step
from teamformer.record.snapshots.deeds import Deed
from teamformer.record.snapshots.events_seen import EventsSeen
from teamformer.world.continuous.events import Passed
from teamformer.world.continuous.pauses import with_pauses
from teamformer.world.continuous.ways import Stage, way_together
from teamformer.world.rules.constants import NOBODY


class WatchInTime(Watch):
    """A watch that writes down events; see `Watch`."""

    def __init__(self, mission: FleetMission) -> None:
        super().__init__(mission)
        self.seen = EventsSeen()
        self._made = 0
        self._under_way = set[int]()  # what robots were at work on before it came
        starts = enumerate(mission.source.robots)
        self._last = {robot: Passed(0.0, at.at) for robot, at in starts}  # where each was seen
        self._shown = dict.fromkeys(range(mission.robots), (NOBODY, True))  # its task, is it there
        self._charging = set[int]()

    @property
    def made(self) -> int:
        """Return how many units of time have been written down."""
        return self._made

    def begin(self, age: float) -> None:
        """Write down what agents tell that they did, of a mission that has been going on."""
        past = int(age / self.mission.step)
        told = [key for key in self._news if key in self._told and self._deed(key).robots]
        for key in sorted(told, key=lambda key: self._told[key].at):
            at = min(self.mission.in_time(self._told[key].at), past)
            self._tell_appeared(at)
            self._tell_done(at, self._deed(key))
        self._news = [key for key in self._news if key not in told]
        self._made = past
        self._under_way = {w.goal for w in self.words.values() if w.phase == SERVE}
        self._done = dict.fromkeys(self._done, past + 1)
        self.at_work.begin(past)

    def step(self) -> Step:
        """Write down what has changed in a unit of time; the step is empty."""
        self._made += 1
        now = float(self._made)
        self._tell_appeared(now)
        for robot, word in sorted(self.words.items()):
            if word.is_lost != (robot in self.seen.lost):
                place = self._as_place(word.x, word.y)
                self.seen.tell(now, "lost" if word.is_lost else "back", (robot,), place=place)
            if not word.is_lost:
                self._tell_robot(now, robot, word)
        ripe, deeds = self._ripe_deeds(self.is_closed)
        for deed in deeds:
            self._tell_done(now, deed)
        self._news = [key for key in self._news if key not in ripe]
        self._tell_services(now)
        self._note_called_off()
        for key in self._off:
            self.seen.tell(now, "cancel", (), self._number[key])
        if self.is_closed:
            self.seen.miss_the_rest(now, self.source)
        return Step()

    def record(self) -> Record:
        """Return what has been seen so far; it ends when the last task is over."""
        is_over = len(self.seen.over) == len(self.source.tasks)
        at = max(self.seen.over.values(), default=0.0) if is_over else float(self._made)
        return self.seen.record(self.source, at, self._status(self.seen.missed, is_over))

    def _tell_appeared(self, now: float) -> None:
        known = {event.task for event in self.seen.events if event.kind == "appear"}
        for number, task in enumerate(self.source.tasks):
            if 0 < task.appears <= now and number not in known:
                self.seen.tell(now, "appear", (), number)

    def _tell_robot(self, now: float, robot: int, word: Word) -> None:
        """Tell that a robot sets out, or is there; while it carries, its team is told of."""
        task = self._number.get(word.goal, NOBODY)
        if word.terms is not None and self._tell_charging(now, robot, word.terms):
            return
        is_charger = word.terms is not None and word.terms.charger != NOBODY
        task = NOBODY if is_charger or task in self.seen.over else task
        is_there = task != NOBODY and word.phase >= HERE
        if word.phase == SERVE and word.goal in self._carried:
            return
        place = self._as_place(word.x, word.y)
        if task == NOBODY:
            self._tell_free(now, robot, place)
        elif is_there and self._shown[robot] != (task, True):
            self.seen.tell(now, "arrive", (robot,), task, place=place)
        elif not is_there and self._shown[robot] != (task, False):
            self._tell_walk(now, robot, task, word)
        self._shown[robot] = (task, is_there)
        if place == (word.x, word.y):  # and not between two places of roads
            self._last[robot] = Passed(now, place)

    def _tell_charging(self, now: float, robot: int, terms: Terms) -> bool:
        """Say whether a robot charges, and tell if it has begun to, or is full."""
        is_charging = terms.charger != NOBODY and self.is_first(robot, terms)
        if is_charging and robot not in self._charging:
            battery, charger = self.source.robots[robot].battery, self.source.chargers
            assert battery is not None, "only those with one charge"
            until = now + battery.time_to_full(terms.charge * battery.lasts)
            place = charger[terms.charger].at
            self._tell_free(now, robot, place)
            self.seen.tell(now, "charge", (robot,), place=place, until=until)
            self._last[robot], self._shown[robot] = Passed(now, place), (NOBODY, True)
            self._charging.add(robot)
        elif not is_charging and robot in self._charging:
            self._charging.discard(robot)
            if terms.charge == 1.0:
                self.seen.tell(now, "charged", (robot,), place=self._last[robot].place)
        return is_charging

    def _tell_free(self, now: float, robot: int, place: Place) -> None:
        """Tell where a robot has come that goes to no task."""
        before = self._last[robot]
        if place != before.place:
            way = (before, Passed(now, place))
            self.seen.tell(now, "walk", (robot,), NOBODY, until=now, way=way)
        elif self._shown[robot][0] != NOBODY:
            self.seen.tell(now, "arrive", (robot,), NOBODY, place=place)

    def _tell_walk(self, now: float, robot: int, task: int, word: Word) -> None:
        """Tell that a robot is on its way to a task, and how that leads on from where it is."""
        mission, here = self.mission, self._as_place(word.x, word.y)
        left = word.y if isinstance(self.source.world, Roads) else 0.0
        key = next(key for key, number in self._number.items() if number == task)
        at = self._loads.get(key) or self.tasks[key]
        goal = self._as_place(at.x, at.y)
        start = Passed(now + left / mission.step, here)
        before = self._last[robot]
        way = [before, start] if before.place != here and before.at < start.at else [start]
        if mission.leads(robot, here, goal):
            pace = mission.paces[robot] * mission.step
            stages = mission.ways.stages(here, goal, mission.source.robots[robot].moves)
            way += self._ahead(robot, start, [(place, away / pace) for place, away in stages])
        self.seen.tell(now, "walk", (robot,), task, until=way[-1].at, way=tuple(way))

    def _ahead(self, robot: int, start: Passed, stages: Sequence[Stage]) -> Sequence[Passed]:
        """Return when a robot passes places by its shifts; nothing if the last is over before."""
        it, is_plane = self.source.robots[robot], isinstance(self.source.world, Plane)
        ahead = [Passed(it.rota.walked(start.at, spent), place) for place, spent in stages]
        if not ahead or ahead[-1].at == math.inf:
            return ()
        return with_pauses(it.rota, start, ahead, is_plane and it.delays is None)

    def _tell_services(self, now: float) -> None:
        """Tell who is at work, who carries what, and which loads were set down."""
        for number, at in self._left.items():
            self.seen.tell(now, "broken", (), number, place=(at.x, at.y))
        self._left = {}
        for key, task in self.tasks.items():
            number = self._number[key]
            robots = [robot for robot, word in self.words.items() if word.goal == key]
            robots = [r for r in robots if self.words[r].phase == SERVE and r not in self.seen.lost]
            is_able = self.mission.covers(robots, task.needs) and self._may_begin(number, robots)
            is_told = number in self.seen.over or number in self.seen.at_work
            if is_told or not is_able or key in self._under_way:
                continue
            lay = self._loads.get(key, task)
            until = now + self.mission.in_time(task.duration)
            place = self._as_place(lay.x, lay.y)
            self.seen.tell(now, "serve", sorted(robots), number, place=place, until=until)
        for deed in self._taking(self._lifted()):
            self._tell_lift(now, deed)

    def _may_begin(self, number: int, robots: Sequence[int]) -> bool:
        """Say whether it is told of all before a task that it is over, and of what robots did."""
        busy = {robot for team in self.seen.at_work.values() for robot in team}
        is_next = self.seen.over.keys() >= self.mission.before.get(number, frozenset())
        return is_next and busy.isdisjoint(robots)

    def _tell_lift(self, now: float, deed: Deed) -> None:
        source, mission = self.mission.source, self.mission
        to = self.source.tasks[deed.task].to
        if to is None or deed.task not in self.seen.at_work:
            return
        robots = self.seen.at_work[deed.task]
        movers = [(source.robots[r].moves, mission.paces[r] * mission.step) for r in robots]
        ahead = way_together(mission.ways, movers, deed.at, to)
        way = (Passed(now, deed.at), *(Passed(now + spent, place) for place, spent in ahead))
        said = {"place": deed.at, "way": way, "until": way[-1].at}
        self.seen.tell(now, "lift", robots, deed.task, **said)
        self._carried.add(next(key for key, number in self._number.items() if number == deed.task))

    def _tell_done(self, now: float, deed: Deed) -> None:
        """Tell that a task is done, and by whom if anybody knows."""
        self.seen.tell(now, "done", deed.robots, deed.task, place=deed.at)
        for robot in deed.robots:
            self._last[robot], self._shown[robot] = Passed(now, deed.at), (NOBODY, True)
