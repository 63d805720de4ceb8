"""The autosave of a mission that runs: a file that grows by a line for everything that happens.

So nothing is lost if the server is killed, at any moment: `resuming.py` reads the lines and plays
the mission again. A line has the plans that were made, which may have taken long, so that they are
not made again; and what a step changed, so that it is known to come out the same.
"""

from __future__ import annotations

import contextlib
import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, TextIO

from teamformer.base.whole_files import own_number
from teamformer.files.mission_files import mission_to_tree
from teamformer.live.drawing.drafts import Draft
from teamformer.live.running.happening_trees import happening_to_tree
from teamformer.live.running.live_mission import LiveMission
from teamformer.live.running.page_trees import Tree

NAME = "autosave.jsonl"
"""The file's name, in the folder of results."""

VERSION = 1


@dataclass(frozen=True)
class Identity:
    """A mission's own name, by which pages know it, and the drawing that it is of."""

    id: str
    draft: Draft


class Autosave:
    """Writes a mission down as it goes; without a path it writes nothing.

    If the file cannot be written any more, because the disk is full, say, `warn` is told so once,
    and the mission goes on without.
    """

    def __init__(self, path: Path | None = None, identity: Identity | None = None) -> None:
        self.path, self._identity = path, identity
        self.warn: Callable[[str], None] = lambda _: None
        self._file: TextIO | None = None

    @property
    def id(self) -> str:
        """Return the mission's own name, by which pages know that it is another."""
        return "" if self._identity is None else self._identity.id

    def begin(self, mission: LiveMission) -> None:
        """Begin the file anew with a mission before its first step."""
        self._open("w")
        if self._identity is not None:
            header = {
                "teamformer_live": VERSION,
                **vars(self._identity),
                "draft": vars(self._identity.draft),
                "method": mission.method_name,
                "seed": mission.seed,
                "mission": mission_to_tree(mission.drawn),
            }
            self._write(header, mission)

    def go_on(self) -> None:
        """Go on with the file of a mission that was played again from it."""
        self._open("a")

    def move(self, mission: LiveMission) -> None:
        """Write down the latest step, or what has happened in the time that has passed last."""
        self._write(mission.latest, mission)

    def happen(self, mission: LiveMission) -> None:
        """Write down the latest incident."""
        self._write(
            {"happen": happening_to_tree(mission.incidents[-1][1], mission.source)}, mission
        )

    def undo(self) -> None:
        """Write down that the latest incident was undone."""
        self._write({"undo": True})

    def close(self) -> None:
        """Write down that the mission was ended, not cut off; nothing is written any more."""
        self._write({"end": True})
        self.release()

    def release(self) -> None:
        """Write nothing any more."""
        if self._file is not None:
            with contextlib.suppress(OSError):  # what could not be written is told already
                self._file.close()
            self._file = None

    def _write(self, entry: Tree, mission: LiveMission | None = None) -> None:
        """Write a line, with the plans that were made in the latest move of a mission."""
        if self._file is None:
            return
        made = [] if mission is None else mission.latest_plans
        plans = [{"at": at} | vars(plan) for at, plan in made]
        line = json.dumps(entry | {"plans": plans} if plans else entry, default=own_number)
        try:
            self._file.write(f"{line}\n")
            self._file.flush()
        except OSError as error:
            self._give_up(error)

    def _open(self, mode: Literal["w", "a"]) -> None:
        if self.path is None:
            return
        try:
            self.release()
            self.path.parent.mkdir(parents=True, exist_ok=True)
            self._file = self.path.open(mode, encoding="utf-8")
        except OSError as error:
            self._give_up(error)

    def _give_up(self, error: OSError) -> None:
        self.release()
        self.warn(
            f"{self.path}: cannot be written: {error.strerror}; "
            "the mission goes on without an autosave; save it yourself"
        )
