"""A live mission and all who watch it: one clock, one truth, any number of pages.

The simulator works in a thread, so that pages are heard while it does; a lock has one thing at a
time happen to the mission.
"""

from __future__ import annotations

import asyncio
import contextlib
import math
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

from teamformer.base.errors import TeamformerError
from teamformer.files.mission_files import write_mission
from teamformer.live.keeping.autosave import Autosave
from teamformer.live.running.alarm import Alarm, OnAlerts
from teamformer.live.running.forecasts import forecast
from teamformer.live.running.incidents import (
    Happening,
    LostRobot,
    PlanTakenOver,
    note_of_plans,
    search_plan,
)
from teamformer.live.running.live_mission import LiveMission
from teamformer.live.running.messages import (
    Message,
    read_incident,
    read_message,
    read_search,
    read_speed,
)
from teamformer.live.running.page_trees import (
    Tree,
    done_at_to_tree,
    forecast_to_tree,
    happening_text,
    moment_text,
    news_of_move,
    record_so_far,
    what_happened,
)
from teamformer.live.running.what_if import luck_of, what_if
from teamformer.live.serving.errands import Errands, apart
from teamformer.live.serving.refusals import or_refuse, refusal
from teamformer.live.serving.watchers import Watcher, Watchers
from teamformer.record.files.writing import save_record
from teamformer.record.record import Record
from teamformer.record.telling.latest import LatestTold

AT_ONCE = 0.3
"""Seconds within which a step is made without a word; what takes longer is told to be planned."""

Moment = tuple[float, int]
"""The time of a mission, and how often it has been changed."""

FORECAST, BOUND, SEARCH = "forecast", "bound", "search"
"""What is worked out beside the conversation for all pages; what one has weighed is its own."""


class Session:
    """Steps a mission at its speed and tells all; `on_alerts` is given what is wrong with it."""

    def __init__(
        self,
        mission: LiveMission,
        folder: Path,
        speed: float,
        has_editor: bool = False,
        autosave: Autosave | None = None,
        on_alerts: OnAlerts = lambda new, past: None,
    ) -> None:
        self.mission, self.folder = mission, folder
        self.speed, self.is_playing, self.has_editor = speed, False, has_editor
        self._autosave = autosave or Autosave()
        self._autosave.warn = lambda text: self._tell_all("warning", {"text": text})
        self._alarm = Alarm([robot.name for robot in mission.source.robots], on_alerts)
        self._saved: Moment | None = None  # when that was done last
        self._changes = 0
        self.watchers = Watchers()
        self._tell_all = self.watchers.tell_all
        self.lock, self._wake = asyncio.Lock(), asyncio.Event()
        self._errands, self._told = Errands(), LatestTold()
        self._outlook: Tree | None = None  # what the latest forecast said
        self._is_outdated = False  # since more was shown
        self._planning = ""  # after what a plan is being made, for as long as it is
        self._happening: Happening | None = None  # what that is, where it is an incident
        self._offer: tuple[Moment, PlanTakenOver] | None = None

    async def run(self) -> None:
        """Let time pass while the mission plays, until cancelled."""
        due = time.monotonic()
        while True:
            if not self.is_playing:
                self._wake.clear()
                await self._wake.wait()
                due = time.monotonic()
            seconds, units = self.mission.beat(self.speed)
            await self.move(units)
            due = max(due + seconds, time.monotonic() - seconds)
            with contextlib.suppress(TimeoutError):  # a page that acts need not wait for the step
                self._wake.clear()
                await asyncio.wait_for(self._wake.wait(), max(0.0, due - time.monotonic()))

    def join(self) -> Watcher:
        """Let a page watch: it is sent the mission so far, then what happens."""
        watcher = self.watchers.come()
        watcher.say("mission", {"record": self._record()} | self._state())
        self._tell_all("state", self._state())
        if self._outlook is not None:
            watcher.say("forecast", self._outlook)
        elif not self._errands.is_under_way(FORECAST):
            self._predict()
        if not self._errands.is_under_way(BOUND):
            self._work_out_bound()
        return watcher

    def leave(self, watcher: Watcher) -> None:
        """Let a page go, and what it has weighed."""
        self._errands.end(watcher)
        self.watchers.discard(watcher)
        self._tell_all("state", self._state())

    async def act(self, watcher: Watcher, text: str) -> None:
        """Do what a page asks for, or tell it why not."""
        await or_refuse(watcher, self._do(watcher, text))

    async def move(self, units: float | None = None) -> None:
        """Make a step, or let so much time pass, and tell everybody; by default to what is next."""
        async with self.lock:
            if not self.mission.is_running:
                self._pause()
                return
            upcoming = moment_text(self.mission.source, math.floor(self.mission.now) + 1)
            telling = asyncio.get_running_loop().call_later(AT_ONCE, self._tell_planning, upcoming)
            try:
                await asyncio.to_thread(self.mission.move, units)
            except TeamformerError as error:  # of a policy that is the user's own
                self._tell_all("refused", {"text": str(error)})
                self._pause()
                return
            finally:
                telling.cancel()
                self._planning_is_over()
            self._autosave.move(self.mission)
            self._alarm.look(self.mission)
            self._tell_all(*await asyncio.to_thread(news_of_move, self.mission, self._told))
        if not self.mission.is_running:
            self._pause()
        elif self.mission.has_shown_more:
            self._is_outdated = True
            if not self._errands.is_under_way(FORECAST):
                self._predict()

    async def happen(self, incident: Happening) -> None:
        """Let an incident happen and tell everybody; TeamformerError says why it cannot.

        The lock is held meanwhile. That it has happened is told before robots have planned for it.
        """
        self.mission.mission_with(incident)
        self._happening = incident
        self._tell_planning(happening_text(self.mission, self.mission.now, incident))
        try:
            await asyncio.to_thread(self.mission.happen, incident)
            self._autosave.happen(self.mission)
            self._planning = ""
            text = happening_text(self.mission, *self.mission.incidents[-1])
            record = self._record()
            if self.mission.source.time == "steps":
                record["steps"] = record["steps"][-1:]  # the earlier ones are as they were
            news = {"text": text, "is_loss": isinstance(incident, LostRobot), "record": record}
            self._tell_all("incident", news | self._state())
        finally:
            self._happening = None
            self._planning_is_over()
        self._have_changed()

    async def undo(self) -> None:
        """Go back to just before the latest incident, and tell everybody."""
        self._pause()
        async with self.lock:
            incident = self.mission.undo()
            self._autosave.undo()
            source = self.mission.source
            back = moment_text(source, self.mission.now)
            back = f"Undone: {incident.text(source)}. The mission is back at {back}."
            self._tell_another_past(back)

    async def restart(self) -> None:
        """Go back to the mission's start, with nothing that happened to it, and tell everybody."""
        self._pause()
        async with self.lock:
            self._tell_planning("the mission begins anew")
            try:
                self.mission = await asyncio.to_thread(self.mission.anew)
                self._autosave.begin(self.mission)
                self._planning = ""
                back = "The mission is back at its start; nothing has happened to it."
                self._tell_another_past(back)
            finally:
                self._planning_is_over()

    def close(self) -> None:
        """Let everything end that goes on in the background, and the autosave."""
        self._errands.close()
        self._autosave.close()

    async def record(self) -> Record:
        """Return the record so far, with the bound."""
        async with self.lock:
            return await asyncio.to_thread(self._with_bound)

    def save(self) -> tuple[Path, ...]:
        """Write the record and the mission with all incidents; return their paths."""
        self.folder.mkdir(parents=True, exist_ok=True)
        record, mission = self.folder / "record.json", self.folder / "mission.yaml"
        save_record(self._with_bound(), record)
        write_mission(self.mission.source, mission)
        return record, mission

    @property
    def note(self) -> str:
        """Return what there is to know of what is saved; empty if nothing."""
        return note_of_plans(happening for _, happening in self.mission.incidents)

    async def _do(self, watcher: Watcher, text: str) -> None:
        message = read_message(text)
        actions: dict[str, Callable[[], None]] = {"play": self._play, "pause": self._pause}
        works = {"undo": self.undo, "restart": self.restart, "take_over": self._take_over}
        command = message["do"]
        if command in actions:
            actions[command]()
        elif command in works:
            await works[command]()
        elif command == "step":
            self._pause()
            await self.move()
        elif command == "speed":
            self.speed = read_speed(message, self.mission.source.time)
            self._wake.set()
            self._tell_all("state", self._state())
        elif command == "happen":
            async with self.lock:
                await self.happen(read_incident(message, self.mission.source))
        elif command == "what_if":
            work = self._weigh(watcher, message)
            self._errands.begin(watcher, or_refuse(watcher, work, is_weighed=True))
        elif command == "stop":
            self._stop(watcher)
        elif command == "replan":
            self._search_plan(read_search(message))
        elif command == "save":
            async with self.lock:
                paths = await asyncio.to_thread(self.save)
                self._saved = self._moment()
            watcher.say("saved", {"paths": [str(path) for path in paths], "note": self.note})
            self._tell_all("state", self._state())
        else:
            raise TeamformerError(f"a mission under way cannot '{command}'")

    def _tell_another_past(self, text: str) -> None:
        """Tell everybody the mission whole, for its past is another, and why."""
        self._tell_all("mission", {"record": self._record(), "text": text} | self._state())
        self._have_changed()

    def _have_changed(self) -> None:
        """Have everything worked out again, for the mission is another now."""
        self._changes += 1
        self._told.forget()
        self._alarm.look(self.mission)
        for watcher in self.watchers:
            if self._errands.end(watcher):
                again = "something else has happened meanwhile; ask again"
                watcher.say("refused", refusal(again, is_weighed=True))
        self._predict()
        self._work_out_bound()

    def _play(self) -> None:
        if not self.mission.is_running:
            raise TeamformerError("the mission is over; add a task to go on")
        self.is_playing = True
        self._wake.set()
        self._tell_all("state", self._state())

    def _pause(self) -> None:
        self.is_playing = False
        self._tell_all("state", self._state())

    async def _weigh(self, watcher: Watcher, message: Message) -> None:
        """Tell a page what an incident would cost or gain if it happened now."""
        async with self.lock:
            now = self.mission.as_it_stands()
        incident = read_incident(message, now.source)
        weighed = await apart(partial(what_if, now, incident))
        watcher.say("what_if", weighed.to_tree())
        if now.is_planned:
            luck = {"steps": await apart(partial(luck_of, weighed)), "is_luck": weighed.is_luck}
            watcher.say("luck", luck)

    def _stop(self, watcher: Watcher) -> None:
        """End what a page has weighed, and the search for a plan."""
        if self._errands.end(watcher):
            watcher.say("stopped")
        if self._errands.end(SEARCH):
            self._tell_all("stopped")

    def _search_plan(self, seconds: float) -> None:
        """Begin to search for a better plan; the mission pauses, as the plan is for now."""
        if self._errands.is_under_way(SEARCH):
            raise TeamformerError("a plan is being searched for already")
        self._pause()
        self._errands.begin(SEARCH, self._offer_plan(seconds))

    async def _offer_plan(self, seconds: float) -> None:
        async with self.lock:
            past, moment = self.mission.past(), self._moment()
        self._tell_all("searching", {"seconds": seconds})
        try:
            found = await apart(partial(search_plan, past, seconds))
        except TeamformerError as error:
            self._tell_all("refused", refusal(str(error), is_weighed=True))
            return
        self._offer = (moment, found)
        ends = forecast_to_tree(found.forecast) | {"without": forecast_to_tree(found.without)}
        self._tell_all("offer", ends | {"text": "a plan of central", "at": moment[0]})

    async def _take_over(self) -> None:
        if self._offer is None:
            raise TeamformerError("there is no plan to take over; plan anew")
        (moment, plan), self._offer = self._offer, None
        async with self.lock:
            if moment != self._moment():
                raise TeamformerError("the mission has gone on since then; plan anew")
            await self.happen(plan)

    def _moment(self) -> Moment:
        return self.mission.now, self._changes

    def _predict(self) -> None:
        """Work out the mission's end in the background; only incidents change it."""
        self._outlook = None
        self._errands.begin(FORECAST, self._tell_forecast())

    async def _tell_forecast(self) -> None:
        self._is_outdated = True
        while self._is_outdated:
            self._is_outdated = False
            async with self.lock:
                past = self.mission.past()
            try:
                found = await apart(partial(forecast, past))
            except TeamformerError:  # of a policy; its step will tell more
                self._tell_all("forecast", {"status": "failed"})
                return
            self._outlook = forecast_to_tree(found) | {"done_at": done_at_to_tree(found)}
            self._tell_all("forecast", self._outlook)

    def _work_out_bound(self) -> None:
        self._errands.begin(BOUND, self._tell_bound())

    async def _tell_bound(self) -> None:
        """Work out in the background what no plan can beat; incidents change it."""
        bound = await asyncio.to_thread(self.mission.work_out_bound)
        if bound is not None:
            self._tell_all("bound", {"lower_bound": bound})

    def _tell_planning(self, after: str) -> None:
        """Tell that a plan is being made, and after what."""
        self._planning = after
        self._tell_all("state", self._state())

    def _planning_is_over(self) -> None:
        """Tell so, unless what was planned for was told together with that."""
        if self._planning:
            self._planning = ""
            self._tell_all("state", self._state())

    def _with_bound(self) -> Record:
        self.mission.work_out_bound()
        return self.mission.record()

    def _record(self) -> Tree:
        return record_so_far(self.mission.record(), self.mission.is_running)

    def _state(self) -> Tree:
        return {
            "id": self._autosave.id,
            "is_playing": self.is_playing,
            "now": self.mission.now,
            "speed": self.speed,
            "watchers": len(self.watchers),
            **what_happened(self.mission, self._happening),
            "saved_at": self._saved[0] if self._saved and self._saved[1] == self._changes else None,
            "planning": self._planning,
            "has_editor": self.has_editor,
        }
