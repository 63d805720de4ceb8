"""A running fleet and all who watch it in the browser: what they add, it publishes.

It offers what a session of a live mission does (`live/session.py`), so that the server need not
know which of them it has. The fleet goes its own way: nobody here can stop it, and when this ends
nothing changes.
"""

from __future__ import annotations

import asyncio
import secrets
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from teamformer.base.errors import TeamformerError
from teamformer.fleet.fleet_mission import row_of
from teamformer.fleet.messages import EVERYBODY, OPERATOR, Beat, Notice, Offer, Post, TaskFact
from teamformer.fleet.observer.mission_clock import MissionClock
from teamformer.fleet.observer.silence import Silence
from teamformer.fleet.observer.troubles import troubles
from teamformer.fleet.observer.watch import Watch
from teamformer.fleet.operator import AGAIN, Operator
from teamformer.fleet.transports.transport import Transport
from teamformer.live.running.alarm import OnAlerts
from teamformer.live.running.alerts import Alerts
from teamformer.live.running.incidents import CancelledTask, NewTask
from teamformer.live.running.messages import read_incident, read_message
from teamformer.live.running.page_trees import Tree, record_so_far
from teamformer.live.serving.refusals import or_refuse
from teamformer.live.serving.watchers import Watcher, Watchers
from teamformer.mission.model import Task
from teamformer.record.files.events import event_to_tree
from teamformer.record.files.writing import save_record, step_to_tree
from teamformer.record.record import Record
from teamformer.record.telling.latest import LatestTold
from teamformer.record.telling.whole import told_of
from teamformer.record.told.trees import added_to_tree, news_to_tree

LISTENS = 3.0
"""Seconds that agents have to tell what was done before."""

MOST_PAST = 1_000_000
"""Steps that are written down of the time before it came."""

PATIENCE = 20.0
"""Seconds until a task that too few robots hold is given up."""


class ObserverSession:
    """Hears a fleet, writes down a step each so many seconds and tells everybody.

    `say` tells the person who started it of alerts, which pages show as well; `on_alerts` is given
    them too.
    """

    def __init__(
        self,
        watch: Watch,
        transport: Transport,
        post: Post,
        folder: Path,
        say: Callable[[str], None] = lambda _: None,
        on_alerts: OnAlerts = lambda new, past: None,
    ) -> None:
        self.watch, self.folder = watch, folder
        self.lock = asyncio.Lock()
        self.note = "this is what was seen of the fleet; no record of steps"
        self._transport = transport
        self._post = post
        self._watchers = Watchers()
        self._tell_all = self._watchers.tell_all
        self._operators: dict[int, Operator] = {}
        self._incidents: list[tuple[int, str]] = []
        self._say_aloud, self._on_alerts = say, on_alerts
        self.on_step: Callable[[Record], None] | None = None  # given what was seen so far
        names = tuple(robot.name for robot in watch.mission.source.robots)
        self._silence, self._alerts = Silence(names, time.monotonic()), Alerts(names)
        self._told, self._known = LatestTold(), 0  # the events that pages know
        self._step, self._clock = watch.mission.step, MissionClock(MOST_PAST * watch.mission.step)
        self._has_begun = False  # to write down steps
        transport.listen_to(range(watch.mission.robots))

    async def run(self) -> None:
        """Hear and tell until cancelled."""
        asked = time.monotonic()
        while True:
            came = await asyncio.to_thread(self._transport.receive, min(0.1, AGAIN))
            now = time.monotonic()
            self._hear(came, now)
            is_to_ask = self.watch.wonders if self._has_begun else not self.watch.is_told
            if is_to_ask and now >= asked:
                asked = now + AGAIN
                self._ask_for_facts()
            if self._clock.is_set and not self._has_begun:
                self._begin(now)
            while self._has_begun and self.watch.made < self._clock.age(now) // self._step:
                self._make_step()

    def join(self) -> Watcher:
        """Let a page watch: it is sent what has been seen so far, then what happens."""
        watcher = self._watchers.come()
        watcher.say("mission", {"record": self._record()} | self._state())
        self._tell_all("state", self._state())
        return watcher

    def leave(self, watcher: Watcher) -> None:
        """Let a page go."""
        self._watchers.discard(watcher)
        self._tell_all("state", self._state())

    async def act(self, watcher: Watcher, text: str) -> None:
        """Do what a page asks for, or tell it why not."""
        await or_refuse(watcher, self._do(watcher, text))

    async def record(self) -> Record:
        """Return what has been seen so far."""
        return self.watch.record()

    def save(self) -> tuple[Path, ...]:
        """Write what has been seen; return the path."""
        self.folder.mkdir(parents=True, exist_ok=True)
        path = self.folder / "record.json"
        save_record(self.watch.record(), path)
        return (path,)

    def close(self) -> None:
        """Hear no more."""
        self._transport.close()

    async def _do(self, watcher: Watcher, text: str) -> None:
        message = read_message(text)
        command = message["do"]
        if command == "happen":
            incident = read_incident(message, self.watch.source)
            if isinstance(incident, NewTask):
                await self._add(incident.task)
            elif isinstance(incident, CancelledTask):
                await self._call_off(incident.task)
            else:
                raise TeamformerError(
                    "a fleet's robots are lost and back by themselves; end or start their agents"
                )
        elif command == "acknowledge":
            self._alerts.acknowledge(str(message.get("alert")))
            self._tell_all("state", self._state())
        elif command == "save":
            watcher.say("saved", {"paths": [str(p) for p in self.save()], "note": self.note})
        else:
            raise TeamformerError(
                f"the fleet goes its own way; nobody can '{command}' it from here"
            )

    async def _add(self, new: Task) -> None:
        """Offer a task until enough robots hold it, and tell who does."""
        if new != Task(new.name, new.at, new.needs, new.duration, note=new.note):
            raise TeamformerError(
                "a new task of a fleet has a place, needs and a duration; leave its other keys out"
            )
        mission = self.watch.mission
        caps, name = mission.source.capabilities, new.name
        key = (1 + secrets.randbits(36)) << 24
        x, y = float(new.at[0]), float(new.at[1])
        task = TaskFact(key, name, x, y, row_of(new.needs, caps), new.duration * mission.step)
        if not mission.is_site(x, y):
            raise TeamformerError(f"[{x:g}, {y:g}] is not free on the map; name another place")
        if not mission.can_do(range(mission.robots), task):
            raise TeamformerError(f"all robots together cannot do '{name}'; lower what it needs")
        holders = await self._say_until_held(Operator(task, mission.robots), "accepted")
        self.watch.learn(task)
        self._tell_of_task(f"task {name} accepted, held by {holders}")

    async def _call_off(self, name: str) -> None:
        """Say that a task is called off until enough robots hold that, and tell who does."""
        found = {self.watch.source.tasks[n].name: task for n, task in self.watch.open_tasks()}
        if name not in found:
            raise TeamformerError(f"task '{name}' is over, or there is none", "name an open one")
        operator = Operator(found[name], self.watch.mission.robots, calls_off=True)
        holders = await self._say_until_held(operator, "called off")
        self._tell_of_task(f"task {name} called off, held by {holders}")

    async def _say_until_held(self, operator: Operator, what: str) -> str:
        """Say what an operator has to say until enough robots hold it; return who does."""
        self._operators[operator.task.key] = operator
        deadline = time.monotonic() + PATIENCE
        while not operator.is_accepted and time.monotonic() < deadline:
            self._say(operator.offer())
            await asyncio.sleep(AGAIN)
        del self._operators[operator.task.key]
        robots = self.watch.mission.source.robots
        holders = ", ".join(robots[robot].name for robot in sorted(operator.holders))
        if not operator.is_accepted:
            have = f"only {holders} hold it" if holders else "no robot answered"
            name = operator.task.name
            raise TeamformerError(f"task {name} is not {what}, {have}; it may still be done")
        return holders

    def _hear(self, came: Sequence[bytes], now: float) -> None:
        was_any_heard = self._silence.was_any_heard
        for data in came:
            message, fault = self._post.judge(data)
            if message is None:
                self._silence.refuse(fault)
                continue
            if message.sender != OPERATOR:
                self._silence.hear(message.sender, now)
                body = message.body
                self._clock.hear(body.age if type(body) is Beat else 0.0, now)
            for operator in self._operators.values():
                operator.hear(message)
            for task in self.watch.hear(message):
                if self._has_begun and task.key not in self._operators:  # or told once accepted
                    self._tell_of_task(f"task {task.name} added by an operator")
        if self._silence.was_any_heard != was_any_heard:
            self._tell_all("state", self._state())
        self._find_alerts(now)

    def _find_alerts(self, now: float) -> None:
        """Tell everybody what is wrong, and what no longer is, until all is done."""
        if self.watch.is_over:  # then robots leave
            if self._alerts.held:
                self._on_alerts([], self._alerts.held)
                self._alerts.clear()
                self._tell_all("state", self._state())
            return
        found = troubles(self.watch, self._clock.age(now)) if self._has_begun else []
        born = now - self._clock.age(now)
        found = [it if it.since is None else it._replace(since=born + it.since) for it in found]
        new, past = self._alerts.find([*found, *self._silence.alerts(now)], now)
        for alert in new:
            self._say_aloud(alert.text())
        for alert in past:
            if not alert.is_return:
                self._say_aloud(f"no longer: {alert.what}")
        if new or past:
            self._on_alerts(new, past)
            self._tell_all("state", self._state())

    def _ask_for_facts(self) -> None:
        """Offer a task that all know: who holds it says what else it knows."""
        if self.watch.mission.tasks:
            self._say(Notice(EVERYBODY, Offer(self.watch.mission.tasks[0])))

    def _say(self, notice: Notice) -> None:
        self._transport.send(notice.to, self._post.seal(OPERATOR, notice))

    def _begin(self, now: float) -> None:
        """Begin to write down steps, once agents have told what was done before, if it was long."""
        age = self._clock.age(now)
        if age >= self._step and not self.watch.is_told and self._clock.listened(now) < LISTENS:
            return
        self._has_begun = True
        self.watch.begin(age)
        self._tell_all("mission", {"record": self._record()} | self._state())

    def _make_step(self) -> None:
        step = self.watch.step()
        record = self.watch.record()
        if record.is_continuous:
            self._tell_moment(record)
        else:
            told = news_to_tree(self._told.of(record))
            news = {"at": self.watch.made, "step": step_to_tree(step), "told": told}
            self._tell_all("step", news)
        if self.on_step is not None:
            self.on_step(record)

    def _tell_moment(self, record: Record) -> None:
        """Tell what has happened since the latest moment, and how late it is."""
        known, self._known = self._known, len(record.events) - 1  # the last is that it is over
        events = [event_to_tree(event) for event in record.events[known : self._known]]
        news: Tree = {"now": self.watch.made, "events": events, "from": known}
        if events:
            before = replace(record, events=record.events[:known])
            news["told"] = added_to_tree(told_of(before), told_of(record))
        self._tell_all("moment", news)

    def _tell_of_task(self, text: str) -> None:
        self._incidents.append((self.watch.made, text))
        record, is_in_steps = self._record(), self.watch.source.time == "steps"
        if is_in_steps:
            record["steps"] = record["steps"][-1:]
        text = f"{'step' if is_in_steps else 'time'} {self.watch.made}: {text}"
        self._tell_all("incident", {"text": text, "record": record} | self._state())

    def _record(self) -> Tree:
        return record_so_far(self.watch.record(), is_running=True)

    def _state(self) -> Tree:
        speed, is_over = 1 / self.watch.mission.step, self.watch.is_over
        is_heard = self._silence.was_any_heard
        watched = {"is_playing": is_heard, "speed": speed, "watchers": len(self._watchers)}
        told = {"is_heard": is_heard, "is_over": is_over, "alerts": self._alerts_told()}
        told["now"] = self.watch.made
        return watched | {"incidents": self._incidents, "is_fleet": True} | told

    def _alerts_told(self) -> list[Tree]:
        """Return the alerts as pages are told: since which second of the mission, for how long."""
        now, is_set = time.monotonic(), self._clock.is_set
        return [
            {"key": it.key, "what": it.what, "why": it.why, "do": it.do}
            | {"since": self._clock.age(it.since or now) if is_set else None}
            | {"seconds": now - (it.since or now)}
            | {"is_acknowledged": it.key in self._alerts.acknowledged}
            for it in self._alerts.held
        ]
