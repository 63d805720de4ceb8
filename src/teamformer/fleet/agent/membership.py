"""Who is alive: claims of loss and how they are refuted (as in SWIM, Das et al. 2002), losses on
the network, and whether this robot itself is fit to be counted on.

Who was called lost and is heard again is waited for longer the next time (Chandra and Toueg 1996):
else robots whose radios do not reach far would for ever set out together and turn back.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from teamformer.fleet.agent.knowledge import Knowledge
from teamformer.fleet.fleet_mission import FleetMission, Timers
from teamformer.fleet.messages import LIFE, LOST, Word

if TYPE_CHECKING:
    from teamformer.fleet.agent.planning import FleetPlan

LONG_PAUSE = 2.5
"""Seconds between two ticks from which on this robot was itself away, not the others."""

HEARS_ALL = 32
"""Up to so many robots everybody listens to everybody."""

STRETCH = 0.6
MOST_STRETCH = 5.0
"""Timers are stretched by `STRETCH / (1 - loss)`, from 1 to MOST_STRETCH."""

MORE_PATIENT = 1.5
"""How much longer a robot is waited for each time it was called lost and is heard again; in all no
more than the longest walk longer."""

LARGEST_GAP = 10
"""Messages that are missed in a row count as so many: a robot was away, not the network bad."""

PART = 0.12
"""How much of the estimate of loss each message is worth."""


class Membership:
    """Whom this robot takes for alive, and for how long it waits for word of them."""

    def __init__(self, knowledge: Knowledge, timers: Timers, life: int, now: float) -> None:
        self.timers = timers
        self.life = life
        self.count = 0
        self.is_leaving = False
        self.is_fit = True
        self.stretch = 1.0
        self.changes = 1  # grows whenever somebody comes, goes or changes fitness
        self._knowledge = knowledge
        robots = knowledge.mission.robots
        self.seen = [now] * robots  # when something new was last heard of each
        self._direct = [0] * robots  # the newest word that was heard of each directly
        self._patience = [1.0] * robots  # for each, of the seconds after which others are lost
        self._missing = 0.0  # messages missed for each one heard, lately
        self.heard = now  # when anybody was last heard
        self._tick = now
        self.is_stuck = False  # it wants to get on and does not
        self.is_unable = False  # its body says that it cannot do what it is told
        self._is_deaf = False
        self._moved = (now, 0.0, 0.0)

    @property
    def version(self) -> int:
        """Return the version of the own word as it is now."""
        return self.life * LIFE + (LOST if self.is_leaving else 0) + self.count

    def start_tick(self, now: float) -> None:
        """Note the time; if this robot was away for long, do not blame the others for it."""
        away = now - self._tick
        if away > LONG_PAUSE:
            self.seen = [seen + away for seen in self.seen]
            self.heard += away
            self._moved = (self._moved[0] + away, *self._moved[1:])
        self._tick = now

    def hear(self, word: Word, now: float) -> Word | None:
        """Take in a word; return the one that it replaces, if it does.

        Who is called lost, or shown a former life, begins another one.
        """
        if word.robot == self._knowledge.me:
            if word.version > self.version and not self.is_leaving:
                self.life = word.life + 1
                self.changes += 1
            return None
        old = self._knowledge.hear_word(word)
        if old is not None:
            self.seen[word.robot] = now
            if old.is_lost and not word.is_lost:
                self._patience[word.robot] *= MORE_PATIENT
            is_other = (old.version ^ word.version) >= LOST or old.is_fit != word.is_fit
            self.changes += is_other
        return old

    def count_missed(self, word: Word) -> None:
        """Note, at a word heard directly, how many of the same robot's were missed before it."""
        direct, self._direct[word.robot] = self._direct[word.robot], word.version
        gap = word.version - direct
        if gap <= 0 or gap >= LOST:  # an old one, or of another life
            return
        if gap > LARGEST_GAP:
            gap = LARGEST_GAP
        self._missing += PART * (gap - 1 - self._missing)
        stretch = STRETCH * (1.0 + self._missing)  # 1 / (1 - loss), if `missing` for one heard
        self.stretch = 1.0 if stretch < 1.0 else min(stretch, MOST_STRETCH)

    def hear_somebody(self, now: float) -> None:
        """Note that somebody was heard just now: who was deaf is not any more."""
        self.heard = now
        if self._is_deaf:
            self._is_deaf = False
            self.is_fit = not (self.is_stuck or self.is_unable)
            self.changes += 1

    def call_lost(self, now: float, watched: frozenset[int]) -> None:
        """Call those lost of whom nothing new was heard for long."""
        patience = self.timers.lost * self.stretch
        most = patience + self._knowledge.mission.longest_walk
        for robot in watched:
            word = self._knowledge.words[robot]
            is_late = now - self.seen[robot] > min(most, patience * self._patience[robot])
            if is_late and not word.is_lost:
                self._knowledge.words[robot] = replace(word, version=word.version | LOST)
                self.seen[robot] = now
                self.changes += 1

    def watch(self, robots: frozenset[int], now: float) -> None:
        """Begin to listen to robots: they have from now on to be heard."""
        for robot in robots:
            self.seen[robot] = max(self.seen[robot], now)

    def judge_myself(
        self, now: float, x: float, y: float, wants_to_move: bool, waits: float, is_unable: bool
    ) -> None:
        """Say whether this robot is fit: it hears somebody, is able, and gets on where it wants to.

        Who gets on may stand in one place for `waits` seconds.
        """
        before = self.is_stuck, self.is_unable, self.is_fit
        _, was_x, was_y = self._moved
        if (x, y) != (was_x, was_y):
            self._moved = (now, x, y)
            self.is_stuck = False
        elif not wants_to_move and not self.is_stuck:
            self._moved = (now, x, y)
        if now - self._moved[0] > max(self.timers.stuck, waits):
            self.is_stuck = True
        self.is_unable = is_unable
        is_alone = self._knowledge.mission.robots == 1
        self._is_deaf = not is_alone and now - self.heard > self.timers.deaf * self.stretch
        self.is_fit = not (self.is_stuck or self.is_unable or self._is_deaf)
        self.changes += (self.is_stuck, is_unable, self.is_fit) != before

    def doubt_myself(self, now: float, x: float, y: float, waits: float) -> None:
        """Call this robot stuck, until it moves, if it carried a load and long did not get on.

        Another robot may have let go of the load sooner, and this one may be why.
        """
        has_moved = (x, y) != self._moved[1:]
        if not has_moved and now - self._moved[0] > max(self.timers.stuck, waits) / 2:
            self.is_stuck, self.is_fit = True, False
            self.changes += 1

    def is_near(self, robot: int, now: float) -> bool:
        """Say whether there is fresh word of a robot."""
        return now - self.seen[robot] <= self.timers.near * self.stretch

    def live(self) -> frozenset[int]:
        """Return the robots to count on: not called lost, and fit by their own word.

        A robot that hears nobody counts on itself all the same; one that is stuck or unable does
        not.
        """
        words, me = self._knowledge.words, self._knowledge.me
        others = {w.robot for w in words if not w.is_lost and w.is_fit and w.robot != me}
        is_out = self.is_stuck or self.is_unable or self.is_leaving
        return frozenset(others if is_out else others | {me})


def neighbours(robot: int, robots: int) -> frozenset[int]:
    """Return whom to listen to in a large fleet: those 1, 2, 4, ... numbers away."""
    away = 1
    near: set[int] = set()
    while away < robots:
        near |= {(robot + away) % robots, (robot - away) % robots}
        away *= 2
    return frozenset(near - {robot})


class Ears:
    """The robots that one robot, `me`, listens to: those `watched`.

    In a small fleet that is everybody, in a large one neighbours and partners. Where there are
    zones all have to agree on who enters, so there it is everybody, too.
    """

    def __init__(self, mission: FleetMission, me: int) -> None:
        self._is_small = mission.robots <= HEARS_ALL or bool(mission.source.zones)
        self._me = me
        self._neighbours = neighbours(me, mission.robots)
        others = frozenset(range(mission.robots)) - {me}
        self.watched = others if self._is_small else self._neighbours
        self._watched_for = (-1, -1)  # the goal and the plan that it listens for

    def listen_for(self, goal: int, plan: FleetPlan, membership: Membership, now: float) -> None:
        """In a large fleet, listen to neighbours and to those that this robot is to meet."""
        if self._is_small or (goal, plan.note.epoch) == self._watched_for:
            return
        self._watched_for = (goal, plan.note.epoch)
        watched = self._neighbours | frozenset(plan.coalition(goal)) - {self._me}
        membership.watch(watched - self.watched, now)
        self.watched = watched
