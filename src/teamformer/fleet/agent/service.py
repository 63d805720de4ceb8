"""Doing a task together: WALK, HERE, READY, SERVE.

READY is a promise to stay for a while. Service begins when robots that together have what the task
needs have proven, by echoing a word of this robot's own, that their promises still hold. So no
robot begins in vain because of a message that came late.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable

from teamformer.fleet.agent.knowledge import Knowledge
from teamformer.fleet.agent.membership import Membership
from teamformer.fleet.messages import HERE, MOST_RELAYED, READY, SERVE, WALK, Word
from teamformer.world.rules.constants import NOBODY

SURE = 0.75
"""The part of a promise that is relied on: clocks drift."""

MOST_SENT = 64
"""Own words whose time is remembered, to know them again in echoes."""


class Service:
    """Where a robot stands with its task, in which team, and what it has promised."""

    def __init__(self, knowledge: Knowledge, membership: Membership) -> None:
        self.goal = NOBODY
        self.phase = WALK
        self.team = knowledge.me
        self.promised = float("-inf")  # until when this robot stays where it is
        self.formed = float("-inf")  # when the last split or join is over
        self.waits = False  # others are here, and service has not begun or ended for all
        self.has_served = False  # its own part of the task at hand is over
        self._knowledge = knowledge
        self._membership = membership
        self._sent: dict[int, float] = {}  # when the own words were said, by version
        self._order: deque[int] = deque()

    def head_for(self, goal: int, now: float, fellows: frozenset[int]) -> None:
        """Take another task; `fellows` are those of the team that go there too.

        Who parts from others stands for as long as a split takes.
        """
        was_with = [w.robot for w in self._members(now)]
        stay_with = [robot for robot in was_with if robot in fellows]
        self.team = min((self._knowledge.me, *stay_with))
        if len(stay_with) < len(was_with) and goal != NOBODY:
            self.formed = now + self._knowledge.mission.forming
        self.goal, self.phase, self.waits = goal, WALK, False
        self.promised = float("-inf")

    def go_along(self, goal: int, team: int) -> None:
        """Take another task with the whole team."""
        self.goal, self.team, self.phase, self.waits = goal, team, WALK, False
        self.promised = float("-inf")

    @property
    def is_gathering(self) -> bool:
        """Say whether it stands at its task and has promised nothing."""
        return self.phase == HERE

    def _members(self, now: float) -> Iterable[Word]:
        """Return the words of the others that are in this robot's team at its task."""
        if self.goal == NOBODY:
            return
        for word in self._knowledge.words:
            if word.team == self.team and word.goal == self.goal and self._is_fellow(word, now):
                yield word

    def team_here(self, now: float) -> tuple[int, ...]:
        """Return the robots of this one's team that are at its task, itself first."""
        here = (word.robot for word in self._members(now) if word.phase >= HERE)
        return self._knowledge.me, *here

    def is_at_work_on(self, key: int) -> bool:
        """Say whether this robot serves a task."""
        return self.phase == SERVE and self.goal == key

    def at_work(self, now: float) -> tuple[int, ...]:
        """Return the robots of this one's team that serve its task, by number."""
        others = (word.robot for word in self._members(now) if word.phase == SERVE)
        return tuple(sorted((self._knowledge.me, *others)))

    def is_over(self, now: float) -> bool:
        """Say whether robots of this one's team have each done their part that suffice together."""
        if self.phase != SERVE or not self.has_served:
            return False
        over = [w.robot for w in self._members(now) if w.phase == SERVE and w.has_served]
        return self._knowledge.covers((self._knowledge.me, *over), self.goal)

    def is_in_hands(self, key: int, now: float) -> bool:
        """Say whether another robot says that it is at work on a task."""
        return any(
            word.goal == key and word.phase == SERVE and self._is_fellow(word, now)
            for word in self._knowledge.words
        )

    def _is_fellow(self, word: Word, now: float) -> bool:
        me = self._knowledge.me
        near = self._membership.is_near(word.robot, now)
        return word.robot != me and near and not word.is_lost

    def stand_by(
        self,
        now: float,
        is_there: bool,
        is_busy: bool,
        may_begin: bool,
        chosen: int | None = None,
    ) -> None:
        """Go on with the task at hand: gather, promise, begin, break off.

        Nobody promises anything before the task `may_begin`. `chosen` is the team to stand with;
        without one it is that of the lowest robot there.
        """
        if not is_there or self.goal == NOBODY:
            self.phase, self.waits = WALK, False
            return
        going = [w for w in self._knowledge.words if w.goal == self.goal]
        going = [word for word in going if self._is_fellow(word, now)]
        here = [word for word in going if word.phase >= HERE]
        if self.phase != SERVE:
            team = self._choose_team(going, here) if chosen is None else chosen
            if team != self.team:
                self.team = team
                self.formed = now + self._knowledge.mission.forming
        fellows = [word for word in here if word.team == self.team]
        if self.phase != SERVE and (now < self.formed or not may_begin):
            self.phase = HERE
        else:
            self.phase = self._next_phase(now, fellows, is_busy)
        self.waits = self.phase == READY or any(word.phase == READY for word in fellows)
        self.waits = self.waits or self.has_served

    def _choose_team(self, going: list[Word], here: list[Word]) -> int:
        """Return the team that serves here, or is ready to, or else that of the lowest robot."""
        me = self._knowledge.me
        company = {word.robot for word in here} | {me}
        company |= {word.robot for word in going if word.team == self.team}
        for phase in (SERVE, READY):
            teams = [word.team for word in here if word.phase == phase]
            if self.phase == phase:
                teams.append(self.team)
            teams = teams if phase == SERVE else [team for team in teams if team in company]
            if teams:
                break
        return min(teams) if teams else min(company)

    def _next_phase(self, now: float, fellows: list[Word], is_busy: bool) -> int:
        me, covers = self._knowledge.me, self._knowledge.covers
        if not covers((me, *(word.robot for word in fellows)), self.goal):
            return HERE
        if self.phase == SERVE:  # whoever is here without being ready yet soon will be
            return SERVE
        bound = [word.robot for word in fellows if word.phase >= READY and self._holds(word, now)]
        return SERVE if covers((me, *bound), self.goal) and not is_busy else READY

    def _holds(self, word: Word, now: float) -> bool:
        """Say whether a promise certainly holds still.

        It was made after the word that it echoes was said.
        """
        me = self._knowledge.me
        for place in range(0, len(word.echoes), 2):
            if word.echoes[place] == me:
                said = self._sent.get(word.echoes[place + 1])
                return said is not None and now <= said + SURE * word.hold
        return False

    def echoes(self, now: float) -> tuple[int, ...]:
        """Return which words were heard of those that gather for the same task."""
        if self.phase == WALK:
            return ()
        heard: list[int] = []
        for word in self._knowledge.words:
            if word.goal == self.goal and word.phase >= HERE and self._is_fellow(word, now):
                heard += (word.robot, word.version)
        return tuple(heard[: 8 * MOST_RELAYED])

    def said(self, version: int, now: float) -> None:
        """Remember when a word was said; being ready in it was a promise."""
        self._sent[version] = now
        self._order.append(version)
        if len(self._order) > MOST_SENT:
            del self._sent[self._order.popleft()]
        if self.phase >= READY:
            self.promised = now + self.hold

    @property
    def hold(self) -> float:
        """Return for how many seconds READY is a promise to stay."""
        return self._membership.timers.hold * self._membership.stretch
