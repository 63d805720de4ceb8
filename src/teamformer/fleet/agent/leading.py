"""The seam to policies: what one decides for the team that a robot leads, and who follows whom.

The shared plan says which robots go where; a team goes to what comes first in the plan for any of
its robots, and stays together until its policy parts it. Where it stands at its task, the robot
that leads it asks the policy, with a view made of what it knows. Wanting what another team there
has is joining it, towards the lower number: the higher one is called. Wanting less sends robots
off, as in the simulator. A task that the decision names comes first.

A policy may want what never does a task. So where nothing has been done for a while robots do as
the plan wants, until something is done again: the plan cannot block, so neither can any policy.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from teamformer.fleet.agent.knowledge import Knowledge, Remembered
from teamformer.fleet.agent.membership import Membership
from teamformer.fleet.agent.planning import PlanKeeper
from teamformer.fleet.agent.service import Service
from teamformer.fleet.agent.sight import Company, companies, nearest_first, view_of
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.messages import EVERYBODY, READY, LeadNote, Notice, Word
from teamformer.methods.seam.protocol import Policy
from teamformer.mission.parts.grid import Place
from teamformer.world.rules.constants import NOBODY

PATIENCE = 30.0
"""Seconds, besides a walk across the map, in which something must get done under a policy."""

MakePolicy = Callable[[int], Policy | None]
"""Makes the policy of a robot, by its number; None is the plan."""


def warm_up(policy: Policy, mission: FleetMission, robot: int) -> None:
    """Ask a policy about the robot alone at a task, so that it loads what it decides with."""
    task = mission.tasks[0]
    alone = Company(robot, (robot,), (task.x, task.y), task.key, False)
    view = view_of(Knowledge(mission, robot, Remembered()), alone, [], [task.key])
    policy.begin(None, np.random.default_rng(robot))
    policy.decide(view)


class Leading:
    """Asks a policy for the team that this robot leads, or follows the one that leads it."""

    def __init__(
        self,
        knowledge: Knowledge,
        membership: Membership,
        keeper: PlanKeeper,
        service: Service,
        policy: Policy,
        now: float,
    ) -> None:
        self._knowledge, self._membership = knowledge, membership
        self._keeper, self._service = keeper, service
        self._policy = policy
        policy.begin(None, np.random.default_rng(knowledge.me))
        self._patience = PATIENCE + knowledge.mission.longest_walk
        self._done = (len(knowledge.done), now)  # how many tasks, and since when
        self._named = NOBODY  # the task that the last decision named
        self._asked: tuple[object, ...] = ()
        self._asked_at = float("-inf")
        self._answer = LeadNote()

    def rests(self, now: float) -> bool:
        """Say whether nothing was done for so long that the plan decides alone."""
        done = len(self._knowledge.done)
        if done != self._done[0]:
            self._done = (done, now)
        return now - self._done[1] > self._patience

    def hear(self, note: LeadNote, sender: int, now: float) -> None:
        """Do as another robot asks: leave its team, or bring the own one to it."""
        me, service = self._knowledge.me, self._service
        if me in note.sends_off and service.team == sender and service.phase < READY:
            service.team = min(note.sends_off)
            service.formed = now + self._knowledge.mission.forming
        is_lower = note.calls == me == service.team and sender < me
        if is_lower and service.is_gathering and self._knowledge.words[sender].goal == service.goal:
            service.team = sender
            service.formed = now + self._knowledge.mission.forming

    def next_goal(self, now: float) -> int:
        """Return the task to head for: the leader's, or what is first for the own team."""
        keeper, knowledge = self._keeper, self._knowledge
        leader = self._leader(now)
        if leader is not None and self._can_go_to(leader.goal):
            return leader.goal
        if self._named in knowledge.undone:
            return self._named
        robots = self._own(now, (0.0, 0.0)).robots if leader is None else (knowledge.me,)
        wanted = {keeper.next_task(robot) for robot in robots}
        return next((key for key in self._order() if key in wanted), NOBODY)

    def _can_go_to(self, key: int) -> bool:
        """Say whether a task is there to be done, and a way leads this robot to it."""
        knowledge = self._knowledge
        is_open = key in knowledge.undone
        return is_open and knowledge.mission.reach(knowledge.me, knowledge.tasks[key])

    def team(self, now: float) -> int:
        """Return the team that this robot goes with: its leader's, or its own."""
        leader = self._leader(now)
        return self._knowledge.me if leader is None else leader.robot

    def part(self, now: float, place: Place, goal: int, notices: list[Notice]) -> None:
        """Ask the policy who is to go along to the next task, and say so to those who are not."""
        own = self._own(now, place)._replace(goal=goal)
        if len(own.robots) > 1 and self._service.team == own.lead:
            _, answer = self._ask(own, list(self._seen(now, place)))
            if answer.sends_off:
                notices.append(Notice(EVERYBODY, answer))

    def decide(self, now: float, place: Place, notices: list[Notice]) -> int:
        """Return the team to stand with at the task; ask the policy where this robot leads.

        It is asked when what it sees has changed, and once a step.
        """
        me, service = self._knowledge.me, self._service
        team = self.team(now)
        if team != me or not service.is_gathering or now < service.formed:
            return team
        own, seen = self._own(now, place), list(self._seen(now, place))
        state = (own, *seen, self._knowledge.changes, self._keeper.changes)
        if state != self._asked or now - self._asked_at >= self._knowledge.mission.step:
            self._asked, self._asked_at = state, now
            team, self._answer = self._ask(own, seen)
            if self._answer != LeadNote():
                notices.append(Notice(EVERYBODY, self._answer))
        return team

    def _ask(self, own: Company, seen: list[Company]) -> tuple[int, LeadNote]:
        """Return the team to stand with, and what is to be said to others."""
        knowledge, me = self._knowledge, self._knowledge.me
        view = view_of(knowledge, own, seen, self._order())
        decision = self._policy.decide(view)
        if decision.task is not None:
            keys = list(knowledge.tasks)
            named = int(decision.task[0])
            self._named = keys[named] if 0 <= named < len(keys) else NOBODY
        wanted, counts = np.asarray(decision.wanted[0]), view.counts[0]
        if (wanted <= counts).all() and (wanted < counts).any():
            return me, LeadNote(sends_off=self._leavers(own, wanted))
        if (wanted >= counts).all() and (wanted > counts).any():
            for column, team in enumerate(nearest_first(knowledge, own, seen)):
                if column == view.seen_slot.shape[1]:
                    break
                is_it = (view.seen_counts[0, column] == wanted - counts).all()
                if view.can_join[0, column] and view.is_here[0, column] and is_it:
                    return (team.lead, LeadNote()) if team.lead < me else (me, LeadNote(team.lead))
        return me, LeadNote()

    def _leavers(self, own: Company, wanted: np.ndarray) -> tuple[int, ...]:
        """Return who leaves: members stay in robot order while they fit; this robot stays."""
        room, stay, leave = wanted.astype(np.int64), [], []
        for robot in own.robots:
            counts = np.array(self._knowledge.mission.brings[robot])
            if (counts <= room).all():
                room = room - counts
                stay.append(robot)
            else:
                leave.append(robot)
        if not stay or not leave:
            return ()
        return tuple(leave if self._knowledge.me in stay else stay)

    def _order(self) -> list[int]:
        """Return the open tasks in the plan's order, those that it does not have at the end."""
        undone, order = self._knowledge.undone, self._keeper.plan.note.order
        planned = [key for key in order if key in undone]
        return planned + sorted(undone.difference(planned))

    def _leader(self, now: float) -> Word | None:
        """Return the word of who leads this robot; None if that is itself."""
        me, team = self._knowledge.me, self._service.team
        while team < me:
            word = self._knowledge.words[team]
            if not self._counts(word, now):
                return None
            if word.team >= team:  # whose leader joined another one follows along
                return word
            team = word.team
        return None

    def _own(self, now: float, place: Place) -> Company:
        """Return the team that this robot leads."""
        me, service = self._knowledge.me, self._service
        others = [w.robot for w in self._knowledge.words if w.team == me != w.robot]
        here = [robot for robot in others if self._counts(self._knowledge.words[robot], now)]
        return Company(me, tuple(sorted((me, *here))), place, service.goal, False)

    def _seen(self, now: float, place: Place) -> Iterator[Company]:
        """Return the other teams within the sensing radius; in the same place all are."""
        mission, me = self._knowledge.mission, self._knowledge.me
        reach = max(mission.source.sensing_radius, mission.radius) ** 2
        yield from companies(
            word
            for word in self._knowledge.words
            if word.robot != me
            and word.team != me
            and (word.x - place[0]) ** 2 + (word.y - place[1]) ** 2 <= reach
            and self._counts(word, now)
        )

    def _counts(self, word: Word, now: float) -> bool:
        """Say whether a word is fresh, of somebody who is there and can move."""
        return not word.is_lost and word.is_fit and self._membership.is_near(word.robot, now)
