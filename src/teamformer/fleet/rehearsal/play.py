"""Plays a fleet's own agents under a schedule of faults, event by event, as one seed determines.

Time goes on from one event to the next in whole ticks. An agent is ticked when it hears or senses
something new and when it is due, not otherwise.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from msgspec.structs import replace

from teamformer.fleet.agent.agent import Agent
from teamformer.fleet.agent.knowledge import Remembered
from teamformer.fleet.agent.planning import FleetPlan
from teamformer.fleet.bodies.body import Command, Report
from teamformer.fleet.bodies.walking import NEVER, Walked
from teamformer.fleet.bodies.world import FleetWorld
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.messages import OPERATOR, Beat, Message, Notice, Post
from teamformer.fleet.operator import AGAIN
from teamformer.fleet.planner import FleetPlanner
from teamformer.fleet.rehearsal.agenda import Agenda
from teamformer.fleet.rehearsal.checking.trace import (
    Broke,
    Finished,
    Followed,
    Said,
    Sent,
    Trace,
    Worked,
)
from teamformer.fleet.rehearsal.desk import Desk
from teamformer.fleet.rehearsal.ending import EndingWatch
from teamformer.fleet.rehearsal.faults import Faults
from teamformer.fleet.rehearsal.late_reports import EVERY, LateReports
from teamformer.fleet.rehearsal.network import RehearsedNetwork
from teamformer.fleet.rehearsal.outcome import Outcome
from teamformer.world.rules.constants import NOBODY

if TYPE_CHECKING:
    from teamformer.fleet.agent.leading import MakePolicy

TICK = 0.02
"""Seconds; nothing happens between two ticks."""

MOST_WAITING = 500
"""Messages that wait for a robot that is paused; more are lost, the oldest first."""


class Rehearsal:
    """One fleet under one schedule."""

    def __init__(
        self,
        mission: FleetMission,
        planner: FleetPlanner,
        plan: FleetPlan,
        faults: Faults,
        trace: Trace | None = None,
        make_policy: MakePolicy = lambda robot: None,
    ) -> None:
        robots = mission.robots
        self.mission = mission
        self.faults = faults
        self.truth = mission.truth(faults.seed)
        self.world = FleetWorld(mission, self.truth)
        self.trace = trace or Trace()
        self.plan = plan  # that all begin with
        self._planner, self._make_policy = planner, make_policy
        self._post = Post(mission.number, robots)
        self._network = RehearsedNetwork(self._post, faults, self._deliver, mission.apart)
        calm = (0.0,) * robots
        self._skew, self._drift = faults.skew or calm, faults.drift or calm
        self._tick, self.now = 0, 0.0  # the true time in seconds
        self._agenda = Agenda()
        self._wake = [0] * robots  # when each is to be ticked next
        self._due = [0.0] * robots  # what each will be awake for, by its own clock
        self._next_event = NEVER  # of the world, that has been put on the agenda
        self._inbox: list[list[Message]] = [[] for _ in range(robots)]
        self._paused = [0] * robots
        self._saved: list[Remembered | None] = [None] * robots
        self._saved_version = [(-1, -1)] * robots
        self._reports = [
            LateReports(lag, faults.stutter, self._network.chance) for lag in faults.lag or calm
        ]
        self._touched = set(range(robots))  # whose bodies sense something new
        self._sensed = [self.world.report(robot) for robot in range(robots)]
        self._said: list[tuple[int, ...]] = [()] * robots
        self._worked = [(NOBODY, NOBODY)] * robots
        self._moves = 0
        self._finished, self._is_to_look = 0, True  # something a mission can end with has changed
        self._desk = Desk(mission, faults)
        self._ending = EndingWatch(mission, faults, self.world, self._desk.operators)
        self._plans = 0
        self._alive_since = [0.0] * robots
        self._robot_seconds = 0.0
        self.agents: list[Agent | None] = [self._start(robot, None) for robot in range(robots)]
        self._plan_happenings()

    def run(self, deadline: float) -> Outcome:
        """Play until all is done that can be done and the last fault is over, or the deadline."""
        last, over = math.ceil(deadline / TICK), self.faults.over
        self._put(over, "over", 0)
        status = "blocked"
        while self._agenda:
            tick = self._agenda.next_tick()
            if tick > last:
                break
            self._tick, self.now = tick, tick * TICK
            self._step()
            if self._is_to_look and self.now >= over:
                self._is_to_look = False
                ended = self._ending.status(self.now, self._held(), self.agents)
                if ended is not None:
                    status = ended
                    break
        return self._outcome(status)

    def is_promised(self, key: int) -> bool:
        """Say whether an operator was told that its task is accepted, or the task is done."""
        return key in self._desk.accepted() or key in self.world.done

    def _step(self) -> None:
        tick, agenda = self._tick, self._agenda
        awake = self._advance()
        for what, who in agenda.happenings.pop(tick, ()):
            awake |= self._happen(what, who)
        self._note_moves()  # before what agents do then: a way may take no time
        self._touched |= awake
        for sender, receiver, message in agenda.letters.pop(tick, ()):
            if receiver == OPERATOR:
                self._is_to_look |= self._desk.hear(message, self.now, self.trace)
            elif self.agents[receiver] is not None:
                if self.trace.with_messages:
                    kind = type(message.body).__name__.removesuffix("Note").lower()
                    self.trace.events.append(Sent(self.now, sender, receiver, kind))
                self._inbox[receiver].append(message)
                awake.add(receiver)
        for robot in agenda.wakes.pop(tick, ()):
            if self._wake[robot] == tick:
                awake.add(robot)
        for robot in sorted(awake):
            agent = self.agents[robot]
            if agent is not None and not self._paused[robot]:
                self._tick_agent(robot, agent)
        self._note_moves()
        next_event = self.world.next_event
        if next_event != self._next_event and next_event < NEVER:
            self._next_event = next_event
            self._agenda.visit(max(self._tick + 1, math.ceil(next_event / TICK - 1e-9)))

    def _advance(self) -> set[int]:
        """Let the world go on to now."""
        awake = self.world.advance(self.now)
        self._is_to_look |= self.mission.ends_by_places and bool(awake)
        self._note_moves()
        if len(self.world.done) > self._finished:
            for done in list(self.world.done.values())[self._finished :]:
                self.trace.events.append(Finished(done.at, done.key))
            self._finished = len(self.world.done)
            self._is_to_look = True
        return awake

    def _tick_agent(self, robot: int, agent: Agent) -> None:
        inbox = self._inbox[robot]
        if inbox:
            self._inbox[robot] = []
        clock = self._clock(robot)
        if robot in self._touched or clock >= agent.due:
            self._touched.discard(robot)
            self._sensed[robot] = self._report(robot)
        before, plans, plan = agent.command, agent.keeper.made, agent.keeper.plan
        command, notices = agent.tick(clock, self._sensed[robot], inbox)
        if agent.memory_version != self._saved_version[robot]:
            self._saved_version[robot] = agent.memory_version
            self._saved[robot] = replace(agent.remember(clock), seen_at=clock)
            known = agent.knowledge
            self.trace.note_knowledge(self.now, robot, known.called_off, known.seen.keys())
            for key in self.mission.hidden.keys() & known.loads.keys():
                self.trace.note_place(self.now, known.loads[key])
        if agent.keeper.plan is not plan:
            self.trace.events.append(Followed(self.now, robot, agent.keeper.plan.live))
        if command is not before:
            self._note_work(robot, command)
            for other in self.world.command(robot, command):
                self._touched.add(other)
                self._wake_at(other, self._tick + 1)
        for notice in notices:
            self._send(robot, notice)
        if agent.keeper.made > plans:
            self._plans += agent.keeper.made - plans
            self._is_to_look |= self.mission.until < NEVER  # it may have given tasks up
        if self._wake[robot] <= self._tick or agent.due < self._due[robot]:
            self._wake_when_due(robot, agent)

    def _wake_when_due(self, robot: int, agent: Agent) -> None:
        due = (agent.due - self._skew[robot]) / (1 + self._drift[robot])
        self._wake_at(robot, max(self._tick + 1, math.ceil(due / TICK - 1e-9)))
        self._due[robot] = agent.due

    def _clock(self, robot: int) -> float:
        return self._skew[robot] + self.now * (1 + self._drift[robot])

    def _report(self, robot: int) -> Report:
        """Return what the body reports: late, or an older report again, if so it is to be."""
        report = self.world.report(robot)
        reports = self._reports[robot]
        if not reports.lag and not self.faults.stutter:
            return report
        if reports.is_news(report):
            wait = EVERY
            if reports.is_due(self.now, report):
                reports.keep(self.now, report)
                wait = max(reports.lag, EVERY)
            self._wake_at(robot, self._tick + math.ceil(wait / TICK))
            self._touched.add(robot)
        return reports.at(self.now)

    def _note_work(self, robot: int, command: Command) -> None:
        """Write down what a robot begins or stops to do."""
        work = (command.task, command.team) if command.serve else (NOBODY, NOBODY)
        if work != self._worked[robot]:
            self._worked[robot] = work
            self.trace.events.append(Worked(self.now, robot, *work))

    def _note_moves(self) -> None:
        """Write down who has set out, and which loads were taken up or set down."""
        moves = self.world.moves
        if len(moves) > self._moves:
            new = moves[self._moves :]
            self.trace.events += new
            self._moves = len(moves)
            if not all(isinstance(move, Walked) for move in new):
                self._is_to_look = True  # as a load was set down that nobody takes up any more

    def _send(self, robot: int, notice: Notice) -> None:
        body = notice.body
        if type(body) is Beat:
            word = body.word
            said = (word.team, word.goal, word.phase, word.waits_at)
            if said != self._said[robot] or word.phase > 1:
                self._said[robot] = said
                spoken = Said(self.now, robot, *said[:3], word.hold, word.waits_at)
                self.trace.events.append(spoken)
        places = self.world.place if self.faults.radio is not None else None
        receivers = self._receivers(robot)
        self._network.send(self.now, robot, notice, receivers, places)

    def _receivers(self, robot: int) -> list[int]:
        """Return who listens to a robot."""
        agents = enumerate(self.agents)
        return [other for other, it in agents if it is not None and robot in it.ears.watched]

    def _deliver(self, at: float, sender: int, receiver: int, message: Message) -> None:
        tick = max(self._tick + 1, math.ceil(at / TICK))
        self._agenda.letters[tick].append((sender, receiver, message))
        self._agenda.visit(tick)

    def _wake_at(self, robot: int, tick: int) -> None:
        """Tick an agent then; or before, if that is planned already."""
        if self._wake[robot] > self._tick and self._wake[robot] <= tick:
            return
        self._wake[robot], self._due[robot] = tick, NEVER
        self._agenda.wakes[tick].append(robot)
        self._agenda.visit(tick)

    def _start(self, robot: int, remembered: Remembered | None) -> Agent:
        nonce = robot + 1000 * len(self.trace.events)
        return Agent(
            mission=self.mission,
            me=robot,
            planner=self._planner,
            plan=self.plan,
            now=self._clock(robot),
            remembered=remembered,
            nonce=nonce,
            policy=self._make_policy(robot),
        )

    def _plan_happenings(self) -> None:
        faults = self.faults
        for robot in range(self.mission.robots):
            self._wake_at(robot, 1)
        for at, what, which in faults.happenings():
            self._put(at, what, which)
        for number, at in enumerate(self._desk.times):
            self._put(at, "order", number)
        for at in self.mission.off_at.values():
            self._put(at, "over", 0)  # the mission may end with it
        if self.mission.until < NEVER:
            self._put(self.mission.until, "over", 0)
        if faults.junk:
            self._put(0.0, "junk", 0)

    def _put(self, at: float, what: str, who: int) -> None:
        tick = max(self._tick + 1, math.ceil(at / TICK))
        self._agenda.happenings[tick].append((what, who))
        self._agenda.visit(tick)

    def _happen(self, what: str, who: int) -> set[int]:
        """Let a fault begin or end; return the robots that sense it."""
        self._is_to_look = True
        if what == "over":
            return set()
        if what == "order":
            return self._offer(who)
        if what == "junk":
            return self._spoil()
        robot = who
        if what in ("crash", "restart"):
            robot = self.faults.crashes[who].robot
        elif what == "drain":
            robot = self.faults.drained[who].robot
        self.trace.events.append(Broke(self.now, robot, what))
        if what == "crash":
            self.agents[robot] = None
            self._robot_seconds += self.now - self._alive_since[robot]
            self._inbox[robot] = []
            return self.world.kill(robot)
        if what == "restart":
            self._restart(robot, self.faults.crashes[who].keeps_facts)
        elif what == "pause":
            self._paused[robot] += 1
        elif what == "resume":
            self._paused[robot] -= 1
            del self._inbox[robot][:-MOST_WAITING]
        elif what == "stuck":
            return self.world.hold_fast(robot)
        elif what == "drain":
            self.world.drain(robot, self.faults.drained[who].share)
        elif what == "free":
            self.world.let_go(robot)
        return {robot}

    def _restart(self, robot: int, keeps_facts: bool) -> None:
        if self.agents[robot] is not None:
            return
        self.world.revive(robot)
        self._alive_since[robot] = self.now
        self._saved_version[robot] = (-1, -1)
        self._reports[robot].forget()
        self.trace.forget(robot)
        self.trace.events.append(Followed(self.now, robot, self.plan.live))
        saved = self._saved[robot] if keeps_facts else None
        self.agents[robot] = self._start(robot, saved and saved.read_at(self._clock(robot)))

    def _offer(self, number: int) -> set[int]:
        operator = self._desk.operators[number]
        if not operator.is_accepted:
            if operator.calls_off:
                self.world.call_off(operator.task.key)
            else:
                self.world.add_task(operator.task)
            alive = [robot for robot, agent in enumerate(self.agents) if agent is not None]
            self._network.send(self.now, OPERATOR, operator.offer(), alive)
            self._put(self.now + AGAIN, "order", number)
        return set()

    def _spoil(self) -> set[int]:
        """Let a message come that nobody should send."""
        self._post.open(self._network.spoil())
        self._put(self.now + 1 / self.faults.junk, "junk", 0)
        return set()

    def _held(self) -> set[int]:
        """Return what operators added or called off that somebody knows, or will with its disk."""
        agents = [agent for agent in self.agents if agent is not None]
        held = {task.key for agent in agents for task in agent.knowledge.added}
        held |= {key for agent in agents for key in agent.knowledge.called_off}
        for crash in self.faults.crashes:
            saved = self._saved[crash.robot]
            if saved and crash.keeps_facts and crash.back is not None and crash.back > self.now:
                held |= {*(task.key for task in saved.added), *saved.called_off}
        return held

    def _outcome(self, status: str) -> Outcome:
        world, network = self.world, self._network
        alive = [r for r, agent in enumerate(self.agents) if agent is not None]
        seconds = self._robot_seconds + sum(self.now - self._alive_since[r] for r in alive)
        undone, impossible = self._ending.undone(self.now, self._held())
        return Outcome(
            status=status,
            makespan=self._ending.makespan(alive),
            end=self.now,
            tasks_done=len(world.done),
            blocked_tasks={"blocked": undone, "infeasible": impossible}.get(status, ()),
            messages=network.messages,
            bytes=network.bytes,
            received_bytes=network.received_bytes,
            robot_seconds=seconds,
            plans=self._plans,
            dropped=sum(self._post.dropped.values()),
        )
