"""The mind of one robot: hears, senses, decides, commands its body and speaks.

It asks no clock, network or body; what runs it does, here in a rehearsal and on a robot alike.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from teamformer.fleet.agent.entering import ZoneGate
from teamformer.fleet.agent.knowledge import Knowledge, Remembered
from teamformer.fleet.agent.loads import note_load, note_place
from teamformer.fleet.agent.meeting import Meeting
from teamformer.fleet.agent.membership import Ears, Membership
from teamformer.fleet.agent.planning import FleetPlan, PlanKeeper
from teamformer.fleet.agent.service import Service
from teamformer.fleet.agent.steering import Pilot
from teamformer.fleet.agent.voice import Voice
from teamformer.fleet.bodies.body import Command, Report
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.messages import (
    EVERYBODY,
    HERE,
    OPERATOR,
    SERVE,
    WALK,
    Beat,
    CallOff,
    DeedFact,
    FactsNote,
    LeadNote,
    Message,
    NeedsFact,
    Notice,
    Offer,
    PlanNote,
    Receipt,
)
from teamformer.fleet.planner import FleetPlanner
from teamformer.fleet.recharging import Recharge
from teamformer.mission.parts.grid import Place
from teamformer.world.rules.constants import NOBODY

if TYPE_CHECKING:
    from teamformer.fleet.agent.leading import Leading
    from teamformer.methods.seam.protocol import Policy

LOOK = 1.0
"""Seconds between two looks at who is lost and whether this robot gets on."""


class Agent:
    """One robot's mind, to be ticked when something is heard or sensed and when it is `due`."""

    def __init__(
        self,
        mission: FleetMission,
        me: int,
        planner: FleetPlanner,
        plan: FleetPlan,
        now: float,
        remembered: Remembered | None = None,
        nonce: int = 0,
        policy: Policy | None = None,
    ) -> None:
        kept = remembered or Remembered()
        self.mission = mission
        self.me = me
        self.knowledge = Knowledge(mission, me, kept)
        life = kept.life + 1 if remembered else 0
        self.membership = Membership(self.knowledge, mission.timers, life, now)
        self.keeper = PlanKeeper(self.knowledge, plan, planner)
        self.service = Service(self.knowledge, self.membership)
        self.gate = ZoneGate(self.knowledge, self.membership, self.keeper)
        self.meeting = Meeting(self.knowledge, self.membership)
        self.recharge = Recharge(mission, me)
        self.leading = None if policy is None else self._lead_by(policy, now)
        self.pilot = Pilot(self)
        self.voice = Voice(self, now, nonce)
        self.command = Command()
        self.due = now
        self._born = now - kept.age
        self._look_at = now
        self.place = (self.knowledge.words[me].x, self.knowledge.words[me].y)
        self.wanted: Place | None = None  # where it last wanted to go and was not
        self._leaves_when = float("inf")  # the promise that it waits out before it leaves
        self._mates_changes = 0  # grows when somebody says something new about the task at hand
        self._report = Report(*self.place)
        self.lets_go = False  # it has told its body to, which may report that late
        self._decided = -1  # the changes that it has decided upon
        self._plan_at = float("inf")
        self.ears = Ears(mission, me)

    def tick(
        self, now: float, report: Report, inbox: Sequence[Message]
    ) -> tuple[Command, list[Notice]]:
        """Make a step of the mind; return what the body is to do and what is to be said.

        Where nothing was heard or sensed that matters now, there is nothing to decide.
        """
        self.membership.start_tick(now)
        notices: list[Notice] = []
        for message in inbox:
            self._hear(message, now, notices)
        if report.number < self._report.number:
            report = self._report  # this one came late
        if now < self.due and self._changes() == self._decided and report == self._report:
            return self.command, notices
        had_load, self._report = self._reports_load, report
        self.lets_go = self.lets_go and self._reports_load
        self._sense(report, now, notices)
        is_rid = self.has_served or self.command.task in self.knowledge.over
        if had_load and not self._reports_load and not is_rid:
            self.membership.doubt_myself(now, *self.place, self._waits(now))
        self.knowledge.let_happen(self.age(now))
        if now >= self._look_at - LOOK / 4:  # together with a heartbeat, if one is near
            self._look(now)
        self._plan(now, notices)
        self._serve(now, report, notices)
        self.ears.listen_for(self.service.goal, self.keeper.plan, self.membership, now)
        self.command = self.pilot.command(now)
        self.voice.speak(now, self.place, notices)
        self.due = min(self._next_time(now), self.voice.next_beat)
        self._decided = self._changes()
        return self.command, notices

    def _changes(self) -> int:
        """Return what grows whenever there may be something to decide."""
        news = self.knowledge.changes + self.membership.changes
        return news + self._mates_changes + self.keeper.changes

    def age(self, now: float) -> float:
        """Return how long the mission has been going on, in seconds."""
        return max(0.0, now - self._born)

    def leave(self, now: float) -> list[Notice]:
        """Say that this robot leaves the fleet for good, so that nobody waits for it."""
        self.membership.is_leaving = True
        notices: list[Notice] = []
        self.voice.speak(now, self.place, notices, at_once=True)
        return notices

    def remember(self, now: float) -> Remembered:
        """Return what has to outlive a restart."""
        return self.knowledge.remember(self.membership.life, self.age(now))

    @property
    def memory_version(self) -> tuple[int, int]:
        """Return what changes whenever there is more to remember."""
        return self.membership.life, self.knowledge.changes

    @property
    def is_refused(self) -> bool:
        """Say whether an older process has this robot's name."""
        return self.voice.is_refused

    @property
    def is_over(self) -> bool:
        """Say whether every task that this robot knows is over, and none is still to appear."""
        return len(self.knowledge.over) == len(self.knowledge.tasks)

    def _hear(self, message: Message, now: float, notices: list[Notice]) -> None:
        body, sender = message.body, message.sender
        if message.to not in (EVERYBODY, self.me):
            return
        if sender == self.me:
            if type(body) is Beat:
                self.voice.meet_namesake(body, now)
        elif type(body) is Beat:
            self._hear_beat(body, sender, now, notices)
        elif type(body) is PlanNote:
            self.keeper.take(body, now)
        elif type(body) is FactsNote:
            self.knowledge.merge(body, now)
        elif type(body) is LeadNote:
            if self.leading is not None and not self.leading.rests(now):
                self.leading.hear(body, sender, now)
                self._mates_changes += 1
        elif type(body) is CallOff:
            self._hear_call_off(body.key, notices)
        elif type(body) is Offer:
            is_known = body.task.key in self.knowledge.tasks
            if self.knowledge.add_task(body.task):
                notices.append(Notice(OPERATOR, Receipt(body.task.key)))
            if is_known:  # who offers what is known wants to know what is
                notices.append(Notice(OPERATOR, self.knowledge.note_for_onlookers()))

    def _hear_call_off(self, key: int, notices: list[Notice]) -> None:
        """Hold that an operator has called a task off, and tell the others."""
        is_news = key not in self.knowledge.over
        if self.knowledge.call_off(key):
            notices.append(Notice(OPERATOR, Receipt(key, is_called_off=True)))
            if is_news:
                notices.append(Notice(EVERYBODY, self.knowledge.note()))

    def _hear_beat(self, beat: Beat, sender: int, now: float, notices: list[Notice]) -> None:
        membership, words = self.membership, self.knowledge.words
        goal = self.service.goal if self.service.phase != WALK else NOBODY
        if beat.word.life > words[sender].life:
            self.voice.relay_all_again()  # it may have forgotten what is said about others
        for word in (beat.word, *beat.others):
            if word.version > words[word.robot].version:
                old = membership.hear(word, now)
                if old is None:
                    continue
                self._mates_changes += self.gate.hear(word, now)
                if old.is_fit and not word.is_fit:
                    self.voice.hurry()  # it may only not have heard anybody
                if goal != NOBODY and goal in (word.goal, old.goal):
                    self._mates_changes += 1
        membership.count_missed(beat.word)
        membership.hear_somebody(now)
        if beat.word.version < words[sender].version:
            self.voice.relay_again(sender)  # it may not know what is said about it
        for key in beat.news:
            self.knowledge.mark_done(key, now)
        self._born = min(self._born, now - beat.age)
        has_older_plan = beat.plan < self.keeper.plan.version
        differs = beat.digest != self.knowledge.digest
        self.voice.tell(sender, has_older_plan, differs, now, notices)

    def _sense(self, report: Report, now: float, notices: list[Notice]) -> None:
        self.place = (report.x, report.y)
        if self._spends_more(report, now):
            self.keeper.note_shortage()
        self.service.has_served = self.has_served
        if report.leg != self.command.leg or self.command.task not in self.knowledge.tasks:
            return
        task, knowledge = self.command.task, self.knowledge
        is_news = report.needs is not None and knowledge.take_needs(NeedsFact(task, report.needs))
        is_done = report.is_done or self.service.is_over(now)
        if is_done and self.service.is_at_work_on(task):
            knowledge.note_deed(DeedFact(task, self.age(now), self.service.at_work(now)))
        if is_done and knowledge.mark_done(task, now):
            self.voice.hurry()
        elif task in self.mission.hidden:
            is_news |= note_place(knowledge, task, report, self.is_at(task))
        elif self.has_load(task):
            is_held = report.is_busy or self.service.is_in_hands(task, now)
            is_news |= note_load(knowledge, task, report, not is_held and self.is_at(task))
        if not is_done and not report.is_gone and self.is_at(task):
            self.keeper.note_look(task)
        if is_news:
            notices.append(Notice(EVERYBODY, knowledge.note()))

    def _spends_more(self, report: Report, now: float) -> bool:
        """Take in what a body tells of its battery; say whether it has less than was believed."""
        command, is_serving = self.command, self.service.phase == SERVE
        moves = command.place is not None or report.carries
        is_at_task = command.task != NOBODY
        return self.recharge.note(report.charge, self.age(now), moves, is_at_task, is_serving)

    def _look(self, now: float) -> None:
        """Look who is lost, and whether this robot gets on."""
        self._look_at = now + LOOK
        self.membership.call_lost(now, self.ears.watched)
        place = self.command.place
        if self.carries:
            place = self.knowledge.tasks[self.command.task].to
        wants_to_move = place is not None and not self.mission.is_same_place(*place, *self.place)
        has_way = not wants_to_move or self.leads(place)
        wants_to_move = wants_to_move and has_way and self.knowledge.is_at_work
        if wants_to_move:
            self.wanted = place
        x, y = self.place
        is_unable = self._report.is_unfit or not has_way
        self.membership.judge_myself(now, x, y, wants_to_move, self._waits(now), is_unable)

    def _waits(self, now: float) -> float:
        """Return for how many seconds it may stand in one place though it gets on."""
        together = self.service.team_here(now) if self.carries else (self.me,)
        return 2.0 * self.mission.step_time(*together)

    def _plan(self, now: float, notices: list[Notice]) -> None:
        self._plan_at = self.keeper.plan_at(now, self.membership)
        if now >= self._plan_at:
            self.keeper.make(self.membership, self.place, now, self.age(now))
            self._plan_at = float("inf")
            notices.append(Notice(EVERYBODY, self.keeper.plan.note))

    def _lead_by(self, policy: Policy, now: float) -> Leading:
        from teamformer.fleet.agent.leading import Leading  # brings the simulator's views

        parts = (self.knowledge, self.membership, self.keeper, self.service)
        return Leading(*parts, policy, now)

    def _serve(self, now: float, report: Report, notices: list[Notice]) -> None:
        service = self.service
        leading = None if self.leading is None or self.leading.rests(now) else self.leading
        self._leaves_when = float("inf")
        goal = self.keeper.next_task(self.me) if leading is None else leading.next_goal(now)
        is_done = service.goal in self.knowledge.done
        is_over = service.goal in self.knowledge.over
        if is_over or (goal != service.goal and service.phase != SERVE):
            if now < service.promised and not is_done:
                service.phase, service.waits = HERE, False  # it takes READY back, and stays
                self._leaves_when = service.promised
                return
            if leading is None:
                service.head_for(goal, now, self._fellows(goal))
            else:
                leading.part(now, self.place, goal, notices)
                service.go_along(goal, leading.team(now))
        is_for_it = report.leg == self.command.leg and self.command.task == service.goal
        is_there = is_for_it and (self.is_bound or self.is_at(service.goal))
        is_there = is_there and not (report.is_unfit or self.recharge.is_away)
        is_there = is_there and self.knowledge.is_at_work
        is_elsewhere = self.has_load(service.goal) or service.goal in self.mission.hidden
        if is_there and is_elsewhere:
            is_on_its_way = self.command.place not in (None, self.knowledge.place_of(service.goal))
            is_there = not (is_on_its_way or report.is_gone or self.membership.is_stuck)
        chosen = None if leading is None else leading.decide(now, self.place, notices)
        may_begin = self.mission.may_begin(service.goal, self.knowledge.over, self.age(now))
        begins = self.knowledge.begins(service.team_here(now), service.goal)
        may_begin = may_begin and begins <= self.knowledge.age
        may_begin = may_begin and self.gate.lets_in(service.goal, now)
        service.stand_by(now, is_there, report.is_busy, may_begin, chosen)

    def leads(self, place: Place | None) -> bool:
        """Say whether a way leads to a place from where this robot is."""
        return place is not None and self.mission.leads(self.me, self.place, place)

    def _fellows(self, goal: int) -> frozenset[int]:
        """Return the robots that go to the same task as this one next."""
        if goal == NOBODY:
            return frozenset()
        coalition = self.keeper.plan.coalition(goal)
        return frozenset(r for r in coalition if self.keeper.next_task(r) == goal)

    def is_at(self, key: int) -> bool:
        """Say whether this robot is where a task is, or its load is believed to lie."""
        if key == NOBODY:
            return False
        return self.mission.is_same_place(*self.knowledge.place_of(key), *self.place)

    @property
    def carries(self) -> bool:
        """Say whether this robot carries the load of the task at hand, and means to go on."""
        return self._reports_load and not self.lets_go

    @property
    def _reports_load(self) -> bool:
        return self._report.carries and self._report.leg == self.command.leg

    @property
    def has_served(self) -> bool:
        """Say whether this robot has done its part of the task that it serves."""
        is_it = self._report.has_served and self._report.leg == self.command.leg
        return is_it and self.service.is_at_work_on(self.command.task)

    @property
    def is_bound(self) -> bool:
        """Say whether it is with its task: it carries or has brought it."""
        return self.carries or self.has_served

    def has_load(self, key: int) -> bool:
        """Say whether a task has a load."""
        return key != NOBODY and self.knowledge.tasks[key].to is not None

    def _next_time(self, now: float) -> float:
        """Return when something is to be decided, even if nothing is heard until then."""
        happens = self._born + self.knowledge.happens_next
        opens = self._born + self.mission.opens.get(self.service.goal, 0.0)
        soon = [self._look_at, self._plan_at, self._leaves_when, happens]
        return min(*soon, *(at for at in (self.service.formed, opens) if at > now))
