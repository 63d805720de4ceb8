"""What an onlooker makes of what robots say: a record with a step for each of the mission.

Who did a task is as one of them tells who did it, or as they were heard at work on it. Of what
nobody can tell it is recorded that it is done by then, and that nobody knows by whom.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Set
from dataclasses import replace

from msgspec import structs

from teamformer.fleet.fleet_mission import FleetMission, place_in
from teamformer.fleet.messages import (
    LONGEST,
    SERVE,
    Beat,
    DeedFact,
    FactsNote,
    LoadFact,
    Message,
    TaskFact,
    Terms,
    Word,
)
from teamformer.fleet.observer.at_work import STAYS, HeardAtWork
from teamformer.mission.model import Task
from teamformer.mission.parts.grid import Grid, Place
from teamformer.mission.parts.plane import DECIMALS
from teamformer.record.phases import CHARGING, QUEUEING
from teamformer.record.record import Record, Step, TaskAt
from teamformer.record.snapshots.deeds import Deed, deed_of, deeds_by_step
from teamformer.record.snapshots.writer import Sighting, SnapshotWriter, fleet_record
from teamformer.world.rules.constants import NOBODY

HEARD_WITHIN = STAYS
"""Steps, or seconds if these are more, within which is heard of what was done before a mission was
over."""

ANSWERS = 1.5
"""Seconds that agents have to tell who did a task, after STAYS steps at the earliest."""


class Watch:
    """Keeps everybody's newest word, the tasks and which are done; `step` writes down what changed.

    Who comes late begins with `begin`, so that steps are numbered as the mission's. A robot is lost
    while its newest word says so. Robots in one place that say they are one team are shown as one,
    and so are, in the step in which it is heard of, those that did a task: they said that they
    serve it, and not much later what they do next.
    """

    def __init__(self, mission: FleetMission) -> None:
        self.mission = mission
        self.source = mission.source
        self.words: dict[int, Word] = {}
        self.at_work = HeardAtWork(self.words)
        self.tasks: dict[int, TaskFact] = {task.key: task for task in mission.tasks}
        self._writer = SnapshotWriter(self.source)
        self.tellers: set[int] = set()  # who has told it what was done before it came
        self._number = {task.key: number for number, task in enumerate(mission.tasks)}
        self._done: dict[int, int] = {}  # task -> step in which that was heard of
        self._off: set[int] = set()  # tasks that are called off, and not done as far as is known
        self._told: dict[int, DeedFact] = {}  # who did what and when, by those who did
        self._news: list[int] = []
        self._loads: dict[int, LoadFact] = {}  # that were moved, by task
        self._left: dict[int, TaskAt] = {}  # those that have been set down since the last step
        self._carried: set[int] = set()
        self._lost: set[int] = set()
        self._were_at: set[int] = set()  # robots that were at chargers in the step before
        self.missed: set[int] = set()  # tasks that were not over when the mission was
        within = max(HEARD_WITHIN, math.ceil(HEARD_WITHIN / mission.step))
        self._closes = mission.in_time(mission.until) + within

    @property
    def steps(self) -> list[Step]:
        """Return the steps written down so far."""
        return self._writer.steps

    @property
    def made(self) -> int:
        """Return how many steps, or units of time, have been written down."""
        return len(self.steps)

    @property
    def is_over(self) -> bool:
        """Say whether all tasks that it knows are done, and told, or called off, or missed."""
        return (
            self.is_closed or self.tasks.keys() <= self._done.keys() | self._off
        ) and not self._news

    @property
    def is_closed(self) -> bool:
        """Say whether the mission is over by its `until`, and all has been heard of before."""
        return self.made >= self._closes

    def open_tasks(self) -> list[tuple[int, TaskFact]]:
        """Return the tasks that are not over, with their numbers."""
        if self.is_closed:
            return []
        left = self.tasks.keys() - self._done.keys() - self._off
        return [(self._number[key], task) for key, task in self.tasks.items() if key in left]

    def hear(self, message: Message) -> list[TaskFact]:
        """Take in a message; return the operators' tasks in it that were not known."""
        body = message.body
        if type(body) is Beat:
            for word in (body.word, *body.others):
                self._take(word)
            for key in body.news:
                self._note_done(key)
        elif type(body) is FactsNote:
            self.tellers.add(message.sender)
            new = [task for task in body.added if self.learn(task)]
            for deed in body.deeds:
                self._take_deed(deed)
            for key in body.done:
                self._note_done(key)
            for load in body.loads:
                self._note_load(load)
            for key in body.called_off:
                self._note_off(key, self.made + 1)
            for seen in body.needs:
                if seen.key in self.mission.unsure:
                    self.tasks[seen.key] = structs.replace(self.tasks[seen.key], needs=seen.needs)
            return new
        return []

    def learn(self, task: TaskFact) -> bool:
        """Take in an operator's task; say whether it was not known."""
        if task.key in self.tasks or len(task.needs) != len(self.source.capabilities):
            return False
        if not self.mission.is_site(task.x, task.y):
            return False
        self._number[task.key] = len(self.tasks)
        self.tasks[task.key] = task
        added = self._as_task(task, self.made)
        self.source = replace(self.source, tasks=(*self.source.tasks, added))
        return True

    @property
    def is_told(self) -> bool:
        """Say whether all that are known to be there have told what was done before it came."""
        there = {robot for robot, word in self.words.items() if not word.is_lost}
        return bool(self.tellers) and there <= self.tellers

    @property
    def wonders(self) -> bool:
        """Say whether a task is done and nobody knows yet by whom: agents may tell."""
        return any(not self._deed(key).robots for key in self._news)

    def begin(self, age: float) -> None:
        """Write down the steps of a mission that has been going on for so many seconds.

        They have what agents tell that they did. Where robots were then, nobody knows; they are
        drawn where they start, or where they did something last.
        """
        step = self.mission.step
        past = int(age / step)
        told = {key: self._deed(key) for key in self._news if key in self._told}
        told = {key: deed for key, deed in told.items() if deed.robots}
        times = sorted((min(self._told[key].at, past * step), key) for key in told)
        rows = deeds_by_step(times, told, step)[:past]
        places = {robot: at.at for robot, at in enumerate(self.source.robots)}
        for deeds in rows:
            said = {robot: (robot, place) for robot, place in places.items()}
            self._writer.add(self.source, Sighting(said, {}, done=deeds))
            places |= {robot: deed.at for deed in deeds for robot in deed.robots}
        written = {deed.task for deeds in rows for deed in deeds}
        self._news = [key for key in self._news if self._number[key] not in written]
        for _ in range(past - len(rows)):
            self._writer.pause(self.source)
        self._done = dict.fromkeys(self._done, past + 1)
        self.at_work.begin(past)

    def step(self) -> Step:
        """Write down what has changed since the last step, and return it.

        Losses come first in a step: who has done something in it is lost in the next. What was done
        is told once there is anybody who may have done it.
        """
        is_last = self.made + 1 >= self._closes
        ripe, deeds = self._ripe_deeds(is_last)
        busy = {robot for deed in deeds for robot in deed.robots} - self._lost
        gone = {robot for robot, word in self.words.items() if word.is_lost} - busy
        if len(gone) == self.mission.robots:
            deeds = []
        lost, back = tuple(sorted(gone - self._lost)), tuple(sorted(self._lost - gone))
        self._lost = gone
        lifted = {robot: lay for robot, lay in self._lifted().items() if robot not in gone}
        said = {
            robot: (NOBODY - robot if robot in back else self._team_of(robot), self._place(robot))
            for robot in range(self.mission.robots)
            if robot not in gone  # who is back is alone at first
        }
        self._carried |= {lay.key for lay in lifted.values()}
        self._news = [key for key in self._news if not said or key not in ripe]
        left, self._left = tuple(self._left.values()), {}
        seen = Sighting(
            said=said,
            aims={robot: self._goal_of(robot) for robot in said},
            at_work=self._served_now(),
            done=deeds,
            taken=self._taking(lifted),
            left=left,
            lost=lost,
            back=back,
            charge=self._at_chargers(said),
            missed=self._given_up({deed.task for deed in deeds}) if is_last else (),
        )
        told = self._writer.add(self.source, seen)
        self._note_called_off()
        return told

    def _given_up(self, done: Set[int]) -> tuple[int, ...]:
        """Return the tasks that are missed as the mission is over, with a step that shows some."""
        told = {task for step in self.steps for task, _ in step.done}
        off = {self._number[key] for key in self._off}
        new = {*range(len(self.source.tasks))} - told - done - off - self.missed
        self.missed |= new
        return tuple(sorted(new))

    def is_first(self, robot: int, own: Terms) -> bool:
        """Say whether a robot is at its charger, and not too many were there before it."""
        said = ((other, word.terms) for other, word in self.words.items() if not word.is_lost)
        ahead = [
            other
            for other, terms in said
            if terms is not None
            and terms.charger == own.charger
            and (terms.since, other) < (own.since, robot)
        ]
        return own.since < LONGEST and len(ahead) < self.source.chargers[own.charger].room

    def _at_chargers(self, robots: Iterable[int]) -> dict[int, str]:
        """Return what robots do at chargers that have been there since the step before."""
        said = {robot: self.words[robot] for robot in robots if robot in self.words}
        there = {r: word.terms for r, word in said.items() if word.waits_at != NOBODY}
        before, self._were_at = self._were_at, set(there)
        return {
            robot: CHARGING if self.is_first(robot, terms) else QUEUEING
            for robot, terms in there.items()
            if terms is not None and robot in before
        }

    def _served_now(self) -> dict[int, tuple[int, ...]]:
        """Return who was heard at work on tasks that is not told of as done, if they suffice."""
        left = self.tasks.keys() - self._done.keys() | set(self._news)
        said = {key: self.at_work.team(key, self.made) for key in left}
        is_able = self.mission.covers
        return {
            self._number[key]: robots
            for key, robots in said.items()
            if key in self._news or is_able(robots, self.tasks[key].needs)
        }

    def _note_called_off(self) -> None:
        """Note the tasks that are called off by now by the mission's file."""
        for number, task in enumerate(self.mission.source.tasks):
            if task.cancelled is not None and task.cancelled <= self.made:
                self._note_off(number, task.cancelled)

    def _ripe_deeds(self, is_last: bool) -> tuple[list[int], list[Deed]]:
        """Return the tasks of which it is to be told now that they are done, and who did them.

        That `is_last` says that the mission is over with it.
        """
        ripe = [key for key in self._news if is_last or self._is_ripe(key)]
        return ripe, [self._deed(key) for key in ripe]

    def record(self) -> Record:
        """Return what has been seen so far; it ends with the step in which all tasks are done."""
        done = sum(len(step.done) for step in self.steps)
        is_over = done + len(self._off) + len(self.missed) == len(self.source.tasks)
        return fleet_record(self.source, self.steps, self._status(self.missed, is_over))

    def _status(self, missed: Set[int], is_over: bool) -> str:
        """Return how the mission has ended, if it has."""
        is_late = any(not self.source.tasks[task].optional for task in missed)
        return "too late" if is_late else "completed" if is_over else "interrupted"

    def _take(self, word: Word) -> None:
        known = self.words.get(word.robot)
        if known is None or word.version > known.version:
            self.words[word.robot] = word
            self.at_work.hear(word, known, self.made)

    def _note_load(self, load: LoadFact) -> None:
        """Note that a load was set down."""
        task, known = self.tasks.get(load.key), self._loads.get(load.key)
        is_news = task is not None and task.to is not None and (known is None or load > known)
        if is_news and self.source.world.is_free((load.x, load.y)):
            self._loads[load.key] = load
            self._carried.discard(load.key)
            number = self._number[load.key]
            self._left[number] = TaskAt(number, *self._as_place(load.x, load.y))

    def _lifted(self) -> dict[int, TaskFact | LoadFact]:
        """Return who says that it is at work on a load which it has carried away since; and that.

        The load is given where it lay.
        """
        found: dict[int, TaskFact | LoadFact] = {}
        for robot, word in self.words.items():
            task = self.tasks.get(word.goal)
            is_load = task is not None and task.to is not None and task.key not in self._done
            if task is None or not is_load or task.key in self._carried or word.phase != SERVE:
                continue
            lay = self._loads.get(task.key, task)
            if not self.mission.is_same_place(word.x, word.y, lay.x, lay.y):
                found[robot] = lay
        return found

    def _taking(self, lifted: Mapping[int, TaskFact | LoadFact]) -> list[Deed]:
        """Return each load that robots say they have taken up, where it lay, with all of them."""
        loads = {lay.key: self._as_place(lay.x, lay.y) for lay in lifted.values()}
        robots = {key: tuple(r for r, lay in lifted.items() if lay.key == key) for key in loads}
        return [Deed(self._number[key], at, robots[key]) for key, at in loads.items()]

    def _note_off(self, key: int, step: float) -> None:
        """Note that a task was called off in a step, if nobody has done it."""
        if key in self.tasks and key not in self._done and key not in self._off:
            self._off.add(key)
            self._set_cancelled(key, step)

    def _set_cancelled(self, key: int, step: float | None) -> None:
        tasks = list(self.source.tasks)
        tasks[self._number[key]] = replace(tasks[self._number[key]], cancelled=step)
        self.source = replace(self.source, tasks=tuple(tasks))

    def _note_done(self, key: int) -> None:
        if key in self.tasks and key not in self._done:
            if key in self._off:  # it was done all the same
                self._off.discard(key)
                self._set_cancelled(key, None)
            self._done[key] = self.made + 1
            self._news.append(key)

    def _place(self, robot: int) -> Place:
        word = self.words.get(robot)
        if word is None:
            return self.source.robots[robot].at
        return self._as_place(word.x, word.y)

    def _as_place(self, x: float, y: float) -> Place:
        if isinstance(self.source.world, Grid):
            return round(x), round(y)
        return place_in(self.source.world, (round(x, DECIMALS), round(y, DECIMALS)))

    def _team_of(self, robot: int) -> int:
        word = self.words.get(robot)
        return robot if word is None or word.team == NOBODY else word.team

    def _goal_of(self, robot: int) -> int | None:
        word = self.words.get(robot)
        number = None if word is None else self._number.get(word.goal)
        return None if number is None or word is None or word.goal in self._done else number

    def _is_ripe(self, key: int) -> bool:
        """Say whether it is known who did a task, or has been waited for.

        The words of some may come after those of another that it is done; not for ever, and nobody
        waits while those who did it leave.
        """
        seen = self.made + 2 - self._done[key]
        is_late = seen >= max(STAYS, math.ceil(ANSWERS / self.mission.step))
        has_left = any(self.words[robot].is_lost for robot in self.at_work.team(key, self.made))
        return is_late or has_left or bool(self._deed(key).robots)

    def _take_deed(self, deed: DeedFact) -> None:
        """Take in what a robot did with others, each of whom may know of more."""
        known = self._told.get(deed.key, deed)
        robots = tuple(sorted({*known.robots, *deed.robots}))
        self._told[deed.key] = DeedFact(deed.key, min(known.at, deed.at), robots)

    def _deed(self, key: int) -> Deed:
        """Return who did a task, as they tell or were heard; nobody if these cannot do it."""
        robots = self._told[key].robots if key in self._told else self.at_work.team(key, self.made)
        if not self.mission.covers(robots, self.tasks[key].needs):
            robots = ()
        return deed_of(self._number[key], self.source.tasks, robots)

    def _as_task(self, task: TaskFact, steps: int) -> Task:
        names = {other.name for other in self.source.tasks}
        name = task.name if task.name not in names else f"{task.name} ({len(names) + 1})"
        at = place_in(self.source.world, (task.x, task.y))
        caps = dict(zip(self.source.capabilities, task.needs, strict=True))
        needs = {cap: count for cap, count in caps.items() if count}
        duration, optional = self.mission.in_time(task.duration), self.mission.may_miss_added
        return Task(name, at, needs, duration, steps, optional=optional)
