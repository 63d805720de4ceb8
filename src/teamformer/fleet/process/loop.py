"""The loop of one agent's process: wait, hear, sense, think, remember, command, speak."""

from __future__ import annotations

import secrets
import signal
import threading
import time
from collections.abc import Sequence
from dataclasses import dataclass
from types import FrameType
from typing import TYPE_CHECKING

from teamformer.fleet.agent.agent import Agent
from teamformer.fleet.agent.planning import FleetPlan
from teamformer.fleet.bodies.body import Body, Report
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.messages import Message, Notice, Post
from teamformer.fleet.methods import PLAN, planner_of, policy_of
from teamformer.fleet.process.facts_file import FactsFile
from teamformer.fleet.process.telling import Telling
from teamformer.fleet.saying import say
from teamformer.fleet.transports.transport import Sluice, Transport

if TYPE_CHECKING:
    from teamformer.fleet.signatures import Signatures

LONGEST_WAIT = 0.1
"""Seconds between two ticks at most."""

FIRST_PLANNERS = 3
"""Robots with the lowest numbers plan first, so they load the planner before they need it."""

FAREWELLS = 3
"""How often a robot says that it leaves."""

REFUSED = 3
"""The exit status of an agent whose name another one has."""


@dataclass
class AgentProcess:
    """One agent with its transport, body and file; `run` returns when it is told to end.

    If it `tells`, it writes what it does, with whom, to stderr.
    """

    mission: FleetMission
    robot: int
    plan: FleetPlan
    transport: Transport
    body: Body
    secret: bytes = b""
    facts: FactsFile | None = None
    signatures: Signatures | None = None
    method: str = PLAN
    tells: bool = False

    def __post_init__(self) -> None:
        self.is_ending = False
        ours = (self.mission.number, self.mission.robots)
        self.post = Post(*ours, self.secret, self.signatures)
        self.sluice = Sluice()
        self._told: dict[str, float] = {}

    def run(self) -> int:
        """Run until SIGTERM or SIGINT; return the exit status."""
        for number in (signal.SIGTERM, signal.SIGINT):
            signal.signal(number, self._end)
        policy = policy_of(self.method, self.robot)
        if policy is not None:  # so that its first answer has not to be waited for
            from teamformer.fleet.agent.leading import warm_up  # brings the simulator's views

            warm_up(policy, self.mission, self.robot)
        report = self._first_report()
        if report is None:
            return 0
        remembered = self.facts.read() if self.facts else None
        planner = planner_of(self.method)
        if self.robot < FIRST_PLANNERS:
            threading.Thread(target=planner.warm_up, daemon=True).start()
        now = time.monotonic()
        ours = (self.mission, self.robot, planner, self.plan)
        agent = Agent(*ours, now, remembered, secrets.randbits(60), policy)
        telling = Telling(agent) if self.tells else None
        saved = self._save(agent, (-1, -1))
        watched: frozenset[int] = frozenset()
        while not self.is_ending:
            if agent.ears.watched != watched:
                watched = agent.ears.watched
                self.transport.listen_to(watched | {self.robot})  # or to who has the same name
            wait = min(LONGEST_WAIT, agent.due - time.monotonic())
            inbox = self._open(self.transport.receive(wait))
            report = self._sense() or report
            command, notices = agent.tick(time.monotonic(), report, inbox)
            for line in telling.news() if telling else ():
                self._say(f"{agent.age(time.monotonic()):.1f} s: {line}")
            if agent.is_refused:
                name = self.mission.source.robots[self.robot].name
                self._say(f"another agent speaks for '{name}', and has done so for longer; ending")
                self.body.close()
                return REFUSED
            saved = self._save(agent, saved)
            self.body.command(command)
            self._send(notices)
        self._leave(agent)
        return 0

    def _first_report(self) -> Report | None:
        """Wait for the body; None if told to end before it reports."""
        begun = time.monotonic()
        while not self.is_ending:
            report = self._sense()
            if report is not None:
                return report
            self.transport.receive(LONGEST_WAIT)
            if time.monotonic() - begun > 10.0:
                begun = time.monotonic()
                self._say("still waiting for the body's first report")
        return None

    def _sense(self) -> Report | None:
        """Return what the body reports; None, told once a minute, where no robot can be."""
        report = self.body.report()
        if report is None or self.mission.can_be_at(self.robot, (report.x, report.y)):
            return report
        if self._is_to_tell("place"):
            place = f"{report.x:g}, {report.y:g}"
            self._say(f"the body reports that it is at {place}, where nobody can be; left aside")
        return None

    def _open(self, came: Sequence[bytes]) -> list[Message]:
        """Open what has come; whatever is no message of this mission is counted, and told once."""
        messages = []
        for data in came:
            message, fault = self.post.judge(data)
            if message is None:
                self.post.dropped[fault] += 1
                self._tell_of(fault)
            elif self.sluice.lets(message.sender, len(data)):
                messages.append(message)
        return messages

    def _is_to_tell(self, fault: str) -> bool:
        """Say whether a fault was not told in the last minute; from then on it was."""
        now = time.monotonic()
        is_new = now - self._told.get(fault, float("-inf")) > 60.0
        if is_new:
            self._told[fault] = now
        return is_new

    def _tell_of(self, fault: str) -> None:
        if self._is_to_tell(fault):
            hint = {
                "another mission": "; do all robots have the same mission file?",
                "bad seal": "; do all robots have the same shared.key in --keys?",
                "not signed": "; do all robots have NAME.pub files in --keys?",
                "bad signature": "; somebody speaks for another, or has another key",
                "forged word": "; somebody tells what another never said",
            }
            self._say(f"dropped a message: {fault}{hint.get(fault, '')}")

    def _save(self, agent: Agent, saved: tuple[int, int]) -> tuple[int, int]:
        """Write what must not be forgotten, before anything is said that relies on it."""
        if self.facts is not None and agent.memory_version != saved:
            self.facts.write(agent.remember(time.monotonic()))
        return agent.memory_version

    def _send(self, notices: list[Notice]) -> None:
        for notice in notices:
            self.transport.send(notice.to, self.post.seal(self.robot, notice))

    def _leave(self, agent: Agent) -> None:
        """Leave in order: say so, and let the body stop."""
        self.body.close()
        for _ in range(FAREWELLS):
            self._send(agent.leave(time.monotonic()))
            time.sleep(0.05)

    def _end(self, _signal: int, _frame: FrameType | None) -> None:
        self.is_ending = True

    def _say(self, message: str) -> None:
        say(self.mission.source.robots[self.robot].name, message)
