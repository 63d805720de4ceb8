"""Where missions are drawn and run: the editor's side of the server, and the way there and back."""

from __future__ import annotations

import asyncio
import contextlib
import secrets
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from teamformer.base.errors import TeamformerError
from teamformer.live.drawing.drafts import (
    EMPTY,
    EXAMPLE,
    Draft,
    can_be_drawn,
    open_draft,
    problems_of,
    read_draft,
    write_draft,
)
from teamformer.live.keeping.autosave import NAME, Autosave, Identity
from teamformer.live.keeping.resuming import Kept, StartMission, play_again
from teamformer.live.running.alarm import OnAlerts
from teamformer.live.running.messages import Message, read_files, read_message
from teamformer.live.running.mission_with_past import RunningMission
from teamformer.live.serving.watchers import Watcher, Watchers
from teamformer.live.session import AT_ONCE, Session
from teamformer.mission.model import Mission
from teamformer.record.record import Record

FIRST_PLAN = "making the first plan"
PLAYED_AGAIN = "playing the mission again up to where it was"
"""What is being done before a mission is there."""


class Workshop:
    """What pages speak to: an editor, or the session of a mission while one runs.

    It offers what a `Session` does, so that the server need not know which of them it has. With a
    `mission`, that of the draft, it begins with running it; with `kept` it goes on with the mission
    of an autosave. `say` tells the person who started it how long the first plan of a mission
    takes. `on_alerts` is given the alerts of missions.
    """

    def __init__(
        self,
        start: StartMission,
        folder: Path,
        speed: float,
        draft: Draft | None = None,
        mission: Mission | None = None,
        say: Callable[[str], None] = lambda _: None,
        kept: Kept | None = None,
        on_alerts: OnAlerts = lambda new, past: None,
    ) -> None:
        self.session: Session | None = None
        self._lock = asyncio.Lock()
        self._start, self._folder, self._speed = start, folder, speed
        self._draft = draft or (Draft(EXAMPLE) if kept is None else kept.identity.draft)
        self._mission, self._kept = mission, kept
        self._say, self._on_alerts = say, on_alerts
        self._is_starting = mission is not None or kept is not None
        self._refusal = ""  # why the latest mission could not be started
        self._doing = FIRST_PLAN  # while there is no mission yet
        self._watchers = Watchers()
        self._clock: asyncio.Task[None] | None = None

    async def run(self) -> None:
        """Begin the mission that there is from the start, and let time pass until cancelled."""
        try:
            if self._kept is not None:
                await self._go_on(self._kept)
            elif self._mission is not None:
                await self._run(self._mission)
            await asyncio.Event().wait()
        finally:
            self._end_session()

    def join(self) -> Watcher:
        """Let a page in: to the mission that runs or is made ready, else to the editor."""
        if self.session is not None:
            return self.session.join()
        watcher = self._watchers.come()
        if self._is_starting:
            self._tell_starting(watcher)
        else:
            self._tell_draft(watcher)
            if self._refusal:
                watcher.say("refused", {"text": self._refusal})
        return watcher

    def leave(self, watcher: Watcher) -> None:
        """Let a page go."""
        self._watchers.discard(watcher)
        if self.session is not None:
            self.session.leave(watcher)

    async def act(self, watcher: Watcher, text: str) -> None:
        """Do what a page asks for, or tell it why not."""
        try:
            message = read_message(text)
            if message["do"] == "edit":
                await self._edit()
            elif self.session is not None:
                await self.session.act(watcher, text)
            else:
                await self._do(watcher, message)
        except TeamformerError as error:
            watcher.say("refused", {"text": str(error)})

    @property
    def note(self) -> str:
        """Return what there is to know of what is saved."""
        return "" if self.session is None else self.session.note

    @property
    def lock(self) -> asyncio.Lock:
        """Return what has one thing at a time happen to the mission, or to what is drawn."""
        return self._lock if self.session is None else self.session.lock

    async def record(self) -> Record | None:
        """Return the record of the mission that runs, if one does."""
        return None if self.session is None else await self.session.record()

    def save(self) -> tuple[Path, ...]:
        """Save the mission, if one runs; drafts are saved when one asks for it."""
        return () if self.session is None else self.session.save()

    async def _do(self, watcher: Watcher, message: Message) -> None:
        command = message["do"]
        if command == "check":
            problems = await asyncio.to_thread(problems_of, self._take(watcher, message))
            watcher.say("checked", {"problems": problems, "id": message.get("id")})
        elif command == "open":
            name, text = message.get("name"), message.get("text")
            if not isinstance(name, str) or not isinstance(text, str):
                raise TeamformerError("a file has a 'name' and a 'text'")
            tree = await asyncio.to_thread(open_draft, name, text, read_files(message))
            is_yaml = name.lower().endswith((".yaml", ".yml"))
            file = str(Path(name).with_suffix(".yaml")) if name.endswith(".map") else name
            self._draft = Draft(tree, file, text if is_yaml else "")
            self._tell_draft(*self._watchers)
        elif command == "new":
            self._draft = Draft(EMPTY)
            self._tell_draft(*self._watchers)
        elif command == "save":
            draft, name = self._take(watcher, message) or {}, message.get("name")
            path = write_draft(draft, name, self._folder, self._draft.text)
            watcher.say("saved", {"paths": [str(path)]})
        elif command == "run":
            await self._run(read_draft(self._take(watcher, message)))
        else:
            raise TeamformerError("no mission runs yet; draw one and run it")

    def _take(self, watcher: Watcher, message: Message) -> Any:
        """Return what a page has drawn; it is kept, and all other pages are shown it.

        What was drawn on another drawing than the one that is kept is refused, and the page is
        shown that: so no page draws over what it has not seen.
        """
        tree, own, after = (message.get(key) for key in ("mission", "id", "after"))
        if own == self._draft.id:
            return tree
        if after not in (None, self._draft.id):
            self._tell_draft(watcher)
            raise TeamformerError("another page has changed the drawing; Undo goes back to yours")
        if can_be_drawn(tree):
            self._draft = replace(self._draft, tree=tree, id=str(own or secrets.token_hex(8)))
            if not self._is_starting:
                self._tell_draft(*self._watchers - {watcher})
        return tree

    def _tell_draft(self, *watchers: Watcher) -> None:
        draft = {"mission": self._draft.tree, "file": self._draft.file, "id": self._draft.id}
        for watcher in watchers:
            watcher.say("editor", draft)

    def _tell_starting(self, *watchers: Watcher) -> None:
        for watcher in watchers:
            watcher.say("starting", {"mission": self._draft.tree, "text": self._doing})

    async def _run(self, source: Mission) -> None:
        """Begin a mission, and have all pages come to it; or tell them why it cannot be run."""
        async with self._lock:
            autosave = Autosave(self._folder / NAME, Identity(secrets.token_hex(8), self._draft))
            mission = await self._made(lambda: self._start(source), FIRST_PLAN)
            if mission is not None:
                autosave.begin(mission)
                self._have_run(mission, autosave)

    async def _go_on(self, kept: Kept) -> None:
        """Go on with the mission of an autosave, as it stood when it was cut off."""
        async with self._lock:
            autosave = Autosave(kept.path, kept.identity)
            mission = await self._made(partial(play_again, kept, self._start), PLAYED_AGAIN)
            if mission is not None:
                autosave.go_on()
                self._have_run(mission, autosave)

    async def _made(self, start: Callable[[], RunningMission], doing: str) -> RunningMission | None:
        """Return a mission once it is made; or tell all pages why it cannot be, and return None."""
        if self.session is not None:
            raise TeamformerError("another page has run a mission already")
        self._is_starting, self._refusal, self._doing = True, "", doing
        begun, loop = time.monotonic(), asyncio.get_running_loop()
        telling = loop.call_later(AT_ONCE, self._say, f"{doing} ...")
        self._tell_starting(*self._watchers)
        try:
            mission = await _start_apart(start)
        except TeamformerError as error:
            self._refuse(str(error))
            return None
        finally:
            telling.cancel()
            self._is_starting = False
        took = time.monotonic() - begun
        if took > AT_ONCE:
            self._say(f"the mission is ready after {took:.1f} s; the page starts it")
        return mission

    def _have_run(self, mission: RunningMission, autosave: Autosave) -> None:
        """Let time pass for a mission, and have all pages come to it."""
        self.session = Session(mission, self._folder, self._speed, True, autosave, self._on_alerts)
        self._clock = asyncio.create_task(self.session.run())
        self._have_all_come_again()

    async def _edit(self) -> None:
        """End the mission that runs, and have all pages come back to its drawing."""
        if self.session is None:
            raise TeamformerError("this is the drawing already")
        async with self._lock, self.session.lock:
            self._watchers |= self.session.watchers
            self._end_session()
            self.session = None
        self._have_all_come_again()

    def _refuse(self, why: str) -> None:
        """Tell everybody that a mission cannot be run."""
        self._refusal = why
        self._say(f"the mission cannot be run: {why}")
        self._watchers.tell_all("refused", {"text": why})

    def _end_session(self) -> None:
        """Let time pass no more; the session can still be saved."""
        if self._clock is not None:
            self._clock.cancel()
        if self.session is not None:
            self.session.close()

    def _have_all_come_again(self) -> None:
        """Have pages load anew: they come to what there is now."""
        self._watchers.tell_all("begun")
        self._watchers.clear()


async def _start_apart(start: Callable[[], RunningMission]) -> RunningMission:
    """Make a mission, with its first plan, in a thread that does not keep Ctrl-C waiting."""
    loop = asyncio.get_running_loop()
    made: asyncio.Future[RunningMission] = loop.create_future()

    def tell(mission: RunningMission | None, error: BaseException | None) -> None:
        if made.done():  # nobody waits any more
            return
        if mission is None:
            made.set_exception(error or RuntimeError("there is no mission"))
        else:
            made.set_result(mission)

    def work() -> None:
        mission: RunningMission | None = None
        error: BaseException | None = None
        try:
            mission = start()
        except BaseException as raised:
            error = raised
        with contextlib.suppress(RuntimeError):  # the server has ended meanwhile
            loop.call_soon_threadsafe(tell, mission, error)

    threading.Thread(target=work, daemon=True).start()
    return await made
