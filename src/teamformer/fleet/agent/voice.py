"""What a robot says, and when: heartbeats, and what others turn out not to know."""

from __future__ import annotations

from typing import TYPE_CHECKING

from teamformer.fleet.messages import EVERYBODY, MOST_RELAYED, Beat, Notice, Terms, Word

if TYPE_CHECKING:
    from teamformer.fleet.agent.agent import Agent

AGAIN = 0.7
"""Seconds until the same robot is told again."""

PATIENCE = 0.4
"""Seconds for which others must lack something before they are told: most is on its way."""


NAMESAKES = 3
"""Messages of another process in this robot's name from which on the younger one gives up."""


class Voice:
    """Speaks for an agent; knows what it said last."""

    def __init__(self, agent: Agent, now: float, nonce: int) -> None:
        self.nonce = nonce
        self.next_beat = now
        self._agent = agent
        self._begun = now
        self._said: tuple[object, ...] = ()
        self._relayed = [-1] * agent.mission.robots
        self._told = [float("-inf")] * agent.mission.robots
        nobody: list[float | None] = [None] * agent.mission.robots
        self._differs = nobody  # since when somebody's facts differ from these
        self._turn = 0
        self._namesakes = 0

    def uptime(self, now: float) -> float:
        """Return for how long this process has been speaking."""
        return now - self._begun

    @property
    def is_refused(self) -> bool:
        """Say whether an older process speaks for this robot."""
        return self._namesakes >= NAMESAKES

    def meet_namesake(self, beat: Beat, now: float) -> None:
        """Give way to another process that speaks for this robot, if that one is older."""
        if beat.nonce != self.nonce and beat.uptime > self.uptime(now):
            self._namesakes += 1

    def hurry(self) -> None:
        """Speak at the next chance: something happened that others wait for."""
        self.next_beat = float("-inf")

    def relay_again(self, robot: int) -> None:
        """Tell others once more what is known of a robot."""
        self._relayed[robot] = -1

    def relay_all_again(self) -> None:
        """Tell others once more what is known of everybody."""
        self._relayed = [-1] * len(self._relayed)

    def tell(
        self, sender: int, has_older_plan: bool, differs: bool, now: float, notices: list[Notice]
    ) -> None:
        """Tell who shows an older plan, or other facts for a while, what is known here."""
        since = self._differs[sender]
        if not differs:
            self._differs[sender] = since = None
        elif since is None:
            self._differs[sender] = since = now
        lacks_facts = since is not None and now - since > PATIENCE
        lacks_plan = has_older_plan and now - self._agent.keeper.since > PATIENCE
        if (lacks_plan or lacks_facts) and now - self._told[sender] > AGAIN:
            self._told[sender] = now
            if lacks_plan:
                notices.append(Notice(sender, self._agent.keeper.plan.note))
            if lacks_facts:
                notices.append(Notice(sender, self._agent.knowledge.note()))

    def speak(
        self,
        now: float,
        place: tuple[float, float],
        notices: list[Notice],
        at_once: bool = False,
    ) -> None:
        """Say a heartbeat if it is time, or if what others act upon has changed."""
        service, membership = self._agent.service, self._agent.membership
        at_hand = (service.goal, service.phase, service.team, service.has_served)
        at_hand = (*at_hand, self._agent.recharge.charger, self._agent.recharge.since)
        state = (*at_hand, membership.is_fit, membership.life)
        if now < self.next_beat and state == self._said and not at_once:
            return
        self._said = state
        timers = membership.timers
        every = timers.hurry if service.waits else timers.beat / membership.stretch
        self.next_beat = now + every
        notices.append(Notice(EVERYBODY, self._beat(now, place)))

    def _beat(self, now: float, place: tuple[float, float]) -> Beat:
        agent, service = self._agent, self._agent.service
        membership, knowledge = agent.membership, agent.knowledge
        membership.count += 1
        word = Word(
            robot=agent.me,
            version=membership.version,
            x=place[0],
            y=place[1],
            team=service.team,
            goal=service.goal,
            phase=service.phase,
            is_fit=membership.is_fit,
            hold=service.hold,
            echoes=service.echoes(now),
            has_served=service.has_served,
            terms=self._terms(),
        )
        knowledge.words[agent.me] = word
        service.said(word.version, now)
        return Beat(
            word=word,
            others=self._others(),
            news=knowledge.news(now),
            digest=knowledge.digest,
            plan=agent.keeper.plan.version,
            age=agent.age(now),
            nonce=self.nonce,
            uptime=self.uptime(now),
        )

    def _terms(self) -> Terms | None:
        """Return what others have to know of this robot where there are zones or batteries."""
        mission = self._agent.mission
        if not mission.source.zones and mission.charging is None:
            return None
        return self._agent.recharge.terms(self._agent.keeper.plan.version[2])

    def _others(self) -> tuple[Word, ...]:
        """Return words that are newer than when they were relayed last, taking turns."""
        words, relayed = self._agent.knowledge.words, self._relayed
        robots, chosen = len(words), []
        for step in range(robots):
            robot = (self._turn + step) % robots
            word = words[robot]
            if word.version > relayed[robot] and robot != self._agent.me:
                relayed[robot] = word.version
                chosen.append(word)
                if len(chosen) == MOST_RELAYED:
                    self._turn = robot + 1
                    break
        return tuple(chosen)
