"""Where missions are drawn: the editor's side of the server, until a draft is run."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from teamformer.errors import TeamformerError
from teamformer.live.drafts import (
    EMPTY,
    can_be_drawn,
    open_draft,
    problems_of,
    read_draft,
    write_draft,
)
from teamformer.live.messages import Message, read_files, read_message
from teamformer.live.mission_with_past import Mission
from teamformer.live.session import Session, Watcher
from teamformer.model import Scenario

StartMission = Callable[[Scenario], Mission]


class Workshop:
    """What pages speak to: an editor at first, and the session of a mission once one runs.

    It offers what a `Session` does, so that the server need not know which of them it has.
    """

    def __init__(self, start: StartMission, folder: Path, speed: float) -> None:
        self.session: Session | None = None
        self.lock = asyncio.Lock()
        self._start, self._folder, self._speed = start, folder, speed
        self._draft: Any = EMPTY
        self._opened = ""  # the text of the YAML file that was opened last
        self._watchers: set[Watcher] = set()
        self._begun = asyncio.Event()

    async def run(self) -> None:
        """Make the steps of the mission, once there is one."""
        await self._begun.wait()
        assert self.session is not None
        await self.session.run()

    def join(self) -> Watcher:
        """Let a page in: to the mission that runs, else to the editor with the latest draft."""
        if self.session is not None:
            return self.session.join()
        watcher = Watcher()
        self._watchers.add(watcher)
        watcher.tell(json.dumps({"kind": "editor", "scenario": self._draft}))
        return watcher

    def leave(self, watcher: Watcher) -> None:
        """Let a page go."""
        self._watchers.discard(watcher)
        if self.session is not None:
            self.session.leave(watcher)

    async def act(self, watcher: Watcher, text: str) -> None:
        """Do what a page asks for, or tell it why not."""
        if self.session is not None:
            await self.session.act(watcher, text)
            return
        try:
            await self._do(watcher, read_message(text))
        except TeamformerError as error:
            watcher.tell(json.dumps({"kind": "refused", "text": str(error)}))

    @property
    def note(self) -> str:
        """Return what there is to know of what is saved."""
        return "" if self.session is None else self.session.note

    def save(self) -> tuple[Path, ...]:
        """Save the mission, if one runs; drafts are saved when one asks for it."""
        return () if self.session is None else self.session.save()

    async def _do(self, watcher: Watcher, message: Message) -> None:
        command = message["do"]
        if command == "check":
            draft = message.get("scenario")
            problems = await asyncio.to_thread(problems_of, draft)
            if can_be_drawn(draft):
                self._draft = draft
            watcher.tell(json.dumps({"kind": "checked", "problems": problems}))
        elif command == "open":
            name, text = message.get("name"), message.get("text")
            if not isinstance(name, str) or not isinstance(text, str):
                raise TeamformerError("a file has a 'name' and a 'text'")
            tree = await asyncio.to_thread(open_draft, name, text, read_files(message))
            self._opened = text if name.lower().endswith((".yaml", ".yml")) else ""
            watcher.tell(json.dumps({"kind": "editor", "scenario": tree}))
        elif command == "save":
            draft, name = message.get("scenario") or {}, message.get("name")
            path = write_draft(draft, name, self._folder, self._opened)
            watcher.tell(json.dumps({"kind": "saved", "paths": [str(path)]}))
        elif command == "run":
            scenario = read_draft(message.get("scenario"))
            watcher.tell(json.dumps({"kind": "starting"}))
            await self._run(scenario)
        else:
            raise TeamformerError("no mission runs yet; draw one and run it")

    async def _run(self, scenario: Scenario) -> None:
        async with self.lock:
            if self.session is not None:
                raise TeamformerError("another page has run a mission already")
            mission = await asyncio.to_thread(self._start, scenario)
            self.session = Session(mission, self._folder, self._speed)
        self._begun.set()
        for watcher in self._watchers:  # they come again, to the mission
            watcher.tell(json.dumps({"kind": "begun"}))
        self._watchers.clear()
