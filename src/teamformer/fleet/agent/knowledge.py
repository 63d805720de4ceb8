"""What one robot knows: everybody's newest word, the tasks, and which of them are done.

All of it merges by taking the larger: words by version, facts as sets that only grow.
"""

from __future__ import annotations

import hashlib
from collections import deque
from collections.abc import Iterable

from msgspec import Struct
from msgspec.msgpack import encode
from msgspec.structs import replace

from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.messages import (
    MOST_DEEDS,
    MOST_MOVES,
    MOST_NEWS,
    MOST_TASKS,
    DeedFact,
    FactsNote,
    LoadFact,
    NeedsFact,
    TaskFact,
    Word,
)
from teamformer.mission.parts.grid import Place
from teamformer.world.rules.constants import NOBODY

NEWS_LAST = 4.0
"""Seconds for which a heartbeat tells of a task that it is done."""

NEVER = float("inf")

MOST_ADDED = 1000
"""Tasks of operators that are held at most, so that nobody can fill a robot's memory."""


class Remembered(Struct, frozen=True, array_like=True):
    """What outlives a restart of the agent."""

    life: int = 0
    done: tuple[int, ...] = ()
    added: tuple[TaskFact, ...] = ()
    age: float = 0.0  # seconds of the mission
    seen_at: float = 0.0  # by the clock of the machine, seconds
    loads: tuple[LoadFact, ...] = ()
    deeds: tuple[DeedFact, ...] = ()
    called_off: tuple[int, ...] = ()
    needs: tuple[NeedsFact, ...] = ()

    def read_at(self, now: float) -> Remembered:
        """Return it as it is when it is read, by the clock of the machine: the mission went on."""
        return replace(self, age=self.age + max(0.0, now - self.seen_at))


class Knowledge:
    """The facts and words that a robot has; `me` is its number."""

    def __init__(self, mission: FleetMission, me: int, remembered: Remembered) -> None:
        self.mission = mission
        self.me = me
        self.words = [
            Word(robot, 0, float(at.at[0]), float(at.at[1]), robot)
            for robot, at in enumerate(mission.source.robots)
        ]
        self.tasks: dict[int, TaskFact] = {task.key: task for task in mission.tasks}
        self.done: set[int] = set()
        self.called_off: set[int] = set()
        self.over: set[int] = set()  # what is done or called off
        self.seen: dict[int, NeedsFact] = {}  # what uncertain tasks really need
        self.loads: dict[int, LoadFact] = {}  # and hidden tasks: those that are elsewhere
        self.deeds = {deed.key: deed for deed in remembered.deeds}  # what this robot has done
        self.digest = 0
        self.changes = 0  # grows with every fact
        self.refused = 0  # facts that made no sense
        self.age = 0.0  # of the mission, when it was looked at last, seconds
        self.is_closed = False  # the mission is over, with whatever is not done
        self._hidden = sorted((t.appears, t.key) for t in mission.tasks if t.appears > 0)[::-1]
        self._ends = sorted((at, key) for key, at in mission.off_at.items())[::-1]
        self._news: deque[tuple[float, int]] = deque(maxlen=MOST_NEWS)
        self.known = {task.key for task in mission.tasks if task.appears == 0}
        self.undone = set(self.known)
        for task in remembered.added:
            self.add_task(task)
        for key in remembered.done:
            self.mark_done(key, 0.0)
        for key in remembered.called_off:
            self.call_off(key)
        for load in remembered.loads:
            self.take_load(load)
        for seen in remembered.needs:
            self.take_needs(seen)

    def hear_word(self, word: Word) -> Word | None:
        """Take a word if it is newer than what is known; return the one that it replaces."""
        old = self.words[word.robot]
        if word.version <= old.version or word.robot == self.me:
            return None
        self.words[word.robot] = word
        return old

    def let_happen(self, age: float) -> None:
        """Let tasks become known, or be called off, whose time has come by the mission's file.

        Once the mission is over by that, all that is not over is missed.
        """
        self.age = age
        while self._hidden and self._hidden[-1][0] <= age:
            self._learn(self._hidden.pop()[1])
        while self._ends and self._ends[-1][0] <= age:
            self.call_off(self._ends.pop()[1])
        if age >= self.mission.until and not self.is_closed:
            self.is_closed = True
            for key in self.tasks:
                self._end(key)

    @property
    def happens_next(self) -> float:
        """Return the mission's age at which its file has something happen next; inf for never."""
        times = [times[-1][0] for times in (self._hidden, self._ends) if times]
        return (
            min(times, default=NEVER) if self.is_closed else min(*times, self.mission.until, NEVER)
        )

    def add_task(self, task: TaskFact) -> bool:
        """Take in a task of an operator; say whether it is held now."""
        if task.key in self.tasks:
            return True
        is_sound = len(task.needs) == len(self.mission.source.capabilities)
        is_sound = is_sound and self.mission.is_site(task.x, task.y) and task.key >= 1 << 24
        if not is_sound or len(self.tasks) >= len(self.mission.tasks) + MOST_ADDED:
            self.refused += 1
            return False
        self.tasks[task.key] = task
        self.digest ^= _hash(task.key, False)
        self._learn(task.key)
        if self.is_closed:
            self._end(task.key)
        return True

    def mark_done(self, key: int, now: float) -> bool:
        """Note that a task is done; a key that nobody knows is refused. Say whether it is news."""
        if key in self.done:
            return False
        if key not in self.tasks:
            self.refused += 1
            return False
        self._learn(key)  # done implies known
        self.done.add(key)
        self._end(key)
        self.digest ^= _hash(key, True)
        self._news.append((now, key))
        return True

    def call_off(self, key: int) -> bool:
        """Note that a task is called off; say whether that is held now."""
        if key not in self.tasks:
            self.refused += 1
            return False
        if key not in self.called_off:
            self._learn(key)
            self.called_off.add(key)
            self._end(key)
            self.digest ^= _hash_of(b"off" + key.to_bytes(8, "big"))
        return True

    def _end(self, key: int) -> None:
        self.over.add(key)
        self.undone.discard(key)
        self.changes += 1

    def take_needs(self, seen: NeedsFact) -> bool:
        """Take in what an uncertain task really needs; say whether that is news."""
        is_sound = seen.key in self.mission.unsure
        if not is_sound or len(seen.needs) != len(self.mission.source.capabilities):
            self.refused += 1
            return False
        known = self.seen.get(seen.key)
        if known is not None and seen.needs <= known.needs:
            return False
        for fact in filter(None, (known, seen)):
            self.digest ^= _hash_of(encode(fact))
        self.seen[seen.key] = seen
        self.tasks[seen.key] = replace(self.tasks[seen.key], needs=seen.needs)
        self.changes += 1
        return True

    def note_deed(self, deed: DeedFact) -> None:
        """Note what this robot has done; if that is very much, the oldest is forgotten."""
        self.deeds.setdefault(deed.key, deed)
        if len(self.deeds) > MOST_DEEDS:
            del self.deeds[next(iter(self.deeds))]

    def place_of(self, key: int) -> Place:
        """Return where a task is, or where its load is believed to lie."""
        at = self.loads.get(key) or self.tasks[key]
        return at.x, at.y

    def heads_to(self, robot: int) -> Place:
        """Return where a robot goes to, or is, by its newest word."""
        word = self.words[robot]
        return self.place_of(word.goal) if word.goal in self.tasks else (word.x, word.y)

    def see_load(self, key: int, place: Place) -> bool:
        """Note that a load lies elsewhere than was believed; say whether that is so."""
        if place == self.place_of(key):
            return False
        version = self.loads[key].version if key in self.loads else 0
        x, y = float(place[0]), float(place[1])
        return self.take_load(LoadFact(key, min(version + 1, MOST_MOVES), x, y))

    def find(self, key: int, place: Place) -> bool:
        """Note where a task is whose place was not known; say whether that is news."""
        known = self.loads.get(key)
        if known is not None and known.version == MOST_MOVES:
            return False
        return self.take_load(LoadFact(key, MOST_MOVES, float(place[0]), float(place[1])))

    def rule_out(self, key: int) -> bool:
        """Note that a task is not where it was believed; the next place to look holds then."""
        known, tour = self.loads.get(key), self.mission.hidden[key]
        version = 1 if known is None else known.version + 1
        if version >= MOST_MOVES:
            return False
        x, y = tour[version % len(tour)]
        return self.take_load(LoadFact(key, version, float(x), float(y)))

    def take_load(self, load: LoadFact) -> bool:
        """Take in where a load or a hidden task is, if that is newer than what is known.

        Say whether it is.
        """
        task, known = self.tasks.get(load.key), self.loads.get(load.key)
        place = (load.x, load.y)
        can_move = task is not None and (task.to is not None or load.key in self.mission.hidden)
        is_sound = can_move and self.mission.is_site(*place)
        if not is_sound or self.mission.region(place) != self.mission.region(self._start_of(load)):
            self.refused += 1
            return False
        if known is not None:
            if load <= known:
                return False
            self.digest ^= _hash_of(encode(known))
        self.loads[load.key] = load
        self.digest ^= _hash_of(encode(load))
        self.changes += 1
        return True

    def _start_of(self, load: LoadFact) -> Place:
        return self.tasks[load.key].x, self.tasks[load.key].y

    def news(self, now: float) -> tuple[int, ...]:
        """Return the tasks that have been done lately."""
        while self._news and self._news[0][0] < now - NEWS_LAST:
            self._news.popleft()
        return tuple(key for _, key in self._news)

    def merge(self, note: FactsNote, now: float) -> None:
        """Take in all facts of another robot."""
        for task in note.added:
            self.add_task(task)
        for key in note.done:
            self.mark_done(key, now)
        for key in note.called_off:
            self.call_off(key)
        for load in note.loads:
            self.take_load(load)
        for seen in note.needs:
            self.take_needs(seen)

    def remember(self, life: int, age: float) -> Remembered:
        """Return what has to outlive a restart."""
        return Remembered(
            life=life,
            done=tuple(sorted(self.done)),
            added=self.added,
            age=age,
            loads=tuple(self.loads.values()),
            deeds=tuple(self.deeds.values()),
            called_off=tuple(sorted(self.called_off)),
            needs=tuple(self.seen.values()),
        )

    def note(self) -> FactsNote:
        """Return all facts, for who knows others."""
        return FactsNote(
            done=tuple(sorted(self.done))[:MOST_TASKS],
            added=self.added,
            digest=self.digest,
            loads=tuple(self.loads.values()),
            called_off=tuple(sorted(self.called_off))[:MOST_TASKS],
            needs=tuple(self.seen.values()),
        )

    def note_for_onlookers(self) -> FactsNote:
        """Return all facts, and what this robot has done with whom."""
        return replace(self.note(), deeds=tuple(self.deeds.values()))

    @property
    def added(self) -> tuple[TaskFact, ...]:
        """Return the tasks of operators."""
        own = len(self.mission.tasks)
        return tuple(self.tasks.values())[own:]

    def open_tasks(self) -> Iterable[TaskFact]:
        """Return the known tasks that are not over, by key, with loads where they lie now."""
        for key in sorted(self.undone):
            task, load = self.tasks[key], self.loads.get(key)
            yield task if load is None else replace(task, x=load.x, y=load.y)

    def located(self, key: int) -> TaskFact | None:
        """Return a task with its load where that lies now; None for NOBODY."""
        task, load = self.tasks.get(key), self.loads.get(key)
        return task if task is None or load is None else replace(task, x=load.x, y=load.y)

    @property
    def is_at_work(self) -> bool:
        """Say whether this robot is in one of its shifts."""
        return self.mission.is_at_work(self.me, self.age)

    def begins(self, robots: Iterable[int], key: int) -> float:
        """Return when robots that stand at a task can begin it: now, with a shift, or never (inf).

        It is to end before the mission is over, and within a shift of each.
        """
        mission = self.mission
        if key not in self.tasks or (mission.until == NEVER and not mission.has_shifts):
            return self.age
        (x, y), who = self.place_of(key), list(robots)
        task = replace(self.tasks[key], x=x, y=y)
        at = mission.fits(task, who, self.age)
        return at if mission.ends_in_time(task, who, at) else NEVER

    def covers(self, robots: Iterable[int], key: int) -> bool:
        """Say whether robots together have what a task needs."""
        return self.mission.covers(robots, self.tasks[key].needs)

    def _learn(self, key: int) -> None:
        if key not in self.known:
            self.known.add(key)
            if key not in self.over:
                self.undone.add(key)
            self.changes += 1


def _hash(key: int, is_done: bool) -> int:
    """Return 62 bits that sum up, by exclusive or, what is known; NOBODY has none."""
    assert key != NOBODY
    return _hash_of(key.to_bytes(8, "big") + bytes([is_done]))


def _hash_of(text: bytes) -> int:
    return int.from_bytes(hashlib.blake2b(text, digest_size=8).digest(), "big") >> 2
