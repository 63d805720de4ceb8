"""Small missions for fleets, and agents that are ticked by hand."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from small_worlds import make, robot, task
from teamformer.fleet.agent.agent import Agent
from teamformer.fleet.agent.planning import FleetPlan, first_plan
from teamformer.fleet.bodies.body import Report
from teamformer.fleet.bodies.journey import Journey
from teamformer.fleet.bodies.walking import Walked
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.messages import OPERATOR, Message, Notice, Post
from teamformer.fleet.observer.watch import Watch
from teamformer.fleet.observer.watch_in_time import WatchInTime
from teamformer.fleet.planner import CoordinatedPlanner
from teamformer.fleet.rehearsal.checking.trace import Trace
from teamformer.fleet.rehearsal.faults import Faults
from teamformer.fleet.rehearsal.outcome import Outcome
from teamformer.fleet.rehearsal.play import Rehearsal
from teamformer.fleet.rehearsal.records.of_rehearsal import record_of
from teamformer.fleet.rehearsal.rehearse import play
from teamformer.mission.model import Task
from teamformer.mission.parts.grid import Place
from teamformer.record.record import Record
from teamformer.record.referee import judge
from teamformer.world.continuous.events import Passed

PLANNER = CoordinatedPlanner()

UNDISTURBED = Faults()


def errand(name: str, x: int, **keys: Any) -> Task:
    """Return a task that needs one `a`, at a place of a corridor."""
    return Task(name, (x, 0), {"a": 1}, **keys)


def errands_of_each_kind() -> list[Task]:
    """Return one for one robot, one for two, and a load."""
    both = replace(errand("both", 14, duration=3), needs={"a": 2})
    return [errand("one", 10, duration=2), both, errand("load", 5, to=(12, 0), unload=1)]


def recorded(fleet: FleetMission, faults: Faults = UNDISTURBED) -> tuple[Outcome, Record]:
    """Return how a rehearsal that keeps every promise ended, and its record, which is right."""
    trace = Trace()
    rehearsal, outcome, violations = play(fleet, plan_of(fleet), faults, trace)
    assert violations == []
    record = record_of(rehearsal, outcome, trace.events, faults.seed)
    assert judge(record).findings == ()
    return outcome, record


def pair() -> FleetMission:
    """Return `a` at 0 and `b` at 4 with a task for both at 6: a..b...T"""
    mission = make([robot("a", 0), robot("b", 4)], [task("ab", 6, duration=2)])
    return FleetMission(mission)


def trio() -> FleetMission:
    """Return `a`, `b` and `c` in one place, with tasks for one, two and all of them."""
    robots = [robot("a", 5), robot("b", 5), robot("c", 5)]
    tasks = [task("a", 2), task("bc", 9), task("abc", 5), task("c", 15), task("ab", 12)]
    return FleetMission(make(robots, tasks))


def plan_of(mission: FleetMission) -> FleetPlan:
    return first_plan(mission, PLANNER)


def agents_of(mission: FleetMission, now: float = 0.0) -> list[Agent]:
    plan = plan_of(mission)
    return [Agent(mission, r, PLANNER, plan, now) for r in range(mission.robots)]


def standing(agent: Agent, number: int) -> Report:
    """Return the report of a body that stands where its robot starts."""
    x, y = agent.mission.source.robots[agent.me].at
    return Report(x, y, agent.command.leg, number=number)


def opened(mission: FleetMission, sender: int, notices: list[Notice]) -> list[Message]:
    """Return notices as the messages that others receive."""
    post = Post(mission.number, mission.robots)
    messages = [post.open(post.seal(sender, notice)) for notice in notices]
    assert all(messages), post.dropped
    return [message for message in messages if message is not None]


def walked(at: float, robot: int, points: Sequence[Place], begin: float, time: float) -> Walked:
    """Return that a robot set out through points, each so many seconds after the one before."""
    way = (Passed(begin + number * time, place) for number, place in enumerate(points))
    return Walked(at, robot, Journey(tuple(way)))


class Watched(Rehearsal):
    """A rehearsal that somebody hears who looks once a step, from some second on.

    Who comes late is told by every agent what was done before.
    """

    def __init__(
        self, mission: FleetMission, since: float = 0.0, faults: Faults = UNDISTURBED
    ) -> None:
        is_in_steps = mission.source.time == "steps"
        self.watch = Watch(mission) if is_in_steps else WatchInTime(mission)
        self._since, self._has_begun = since, since == 0.0
        self._onlooker = Post(mission.number, mission.robots)
        super().__init__(mission, PLANNER, plan_of(mission), faults)

    def _send(self, robot: int, notice: Notice) -> None:
        super()._send(robot, notice)
        if self.now >= self._since:
            self._hear(robot, notice)

    def _hear(self, robot: int, notice: Notice) -> None:
        heard = self._onlooker.open(self._onlooker.seal(robot, notice))
        assert heard is not None
        if not self._has_begun:
            self._come()
        while self._has_begun and self.watch.made < int(self.now / self.mission.step):
            self.watch.step()
        self.watch.hear(heard)

    def _come(self) -> None:
        """Hear what agents know; begin once everybody has been heard for a beat."""
        for me, agent in enumerate(self.agents):
            if agent is not None:
                note = agent.knowledge.note_for_onlookers()
                self.watch.hear(Message(1, self.mission.number, me, OPERATOR, note))
        if not self._has_begun and self.now >= self._since + self.mission.timers.beat:
            self._has_begun = True
            self.watch.begin(self.now)
