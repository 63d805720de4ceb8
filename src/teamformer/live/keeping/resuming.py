"""Goes on with a mission that was cut off: reads its autosave and plays it again."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from teamformer.base.errors import TeamformerError
from teamformer.base.whole_files import own_number, write_whole
from teamformer.files.mission_files import mission_from_tree
from teamformer.live.drawing.drafts import Draft
from teamformer.live.keeping.autosave import NAME, VERSION, Identity
from teamformer.live.running.happening_trees import happening_from_tree, plan_from_tree
from teamformer.live.running.live_mission import LiveMission
from teamformer.live.running.page_trees import Tree, moment_text
from teamformer.mission.coordination import Plan
from teamformer.mission.model import Mission

StartMission = Callable[..., LiveMission]
"""Has a mission run, by the plans that were made for it before, if any were."""

NOT_FOUND = "name the file that a live mission kept: OUT/autosave.jsonl"

PUT_ASIDE = re.compile(r"autosave-(\d+)\.jsonl")


@dataclass(frozen=True)
class Kept:
    """A mission as its autosave has it; `entries` are what is left of its steps and incidents."""

    path: Path
    identity: Identity
    method: str
    seed: int
    mission: Mission
    first_plans: tuple[tuple[float, Plan], ...]
    entries: tuple[Tree, ...]
    is_ended: bool  # it was not cut off

    @property
    def steps(self) -> int:
        """Return how many steps were made."""
        return sum("step" in entry for entry in self.entries)

    def text(self) -> str:
        """Return what there is to go on with, as words."""
        happened = sum("happen" in entry for entry in self.entries)
        times = [entry["now"] for entry in self.entries if "now" in entry]
        what = f"{self.steps} step{'s' * (self.steps != 1)}"
        if self.mission.time == "continuous":
            what = moment_text(self.mission, max(times, default=0))
        if happened:
            what += f" and {happened} incident{'s' * (happened != 1)}"
        return f"mission '{self.mission.name}', {what}"


def read_autosave(path: Path) -> Kept:
    """Return the mission of an autosave; TeamformerError says what is wrong with the file.

    A last line that was being written when the server was killed is left out.
    """
    try:
        lines = path.read_text(encoding="utf-8").split("\n")[:-1]
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is no text"
        raise TeamformerError(f"{path}: cannot be read: {reason}", NOT_FOUND) from None
    if not lines:
        raise TeamformerError(f"{path}: the file is empty", NOT_FOUND)
    rows = [_read_line(path, number, line) for number, line in enumerate(lines, 1)]
    header = rows[0]
    if header.get("teamformer_live") != VERSION:
        raise TeamformerError(f"{path}:1: this is no autosave of version {VERSION}", NOT_FOUND)
    with _refusing_other_content(path):
        return Kept(
            path,
            Identity(header["id"], Draft(**header["draft"])),
            method=header["method"],
            seed=header["seed"],
            mission=mission_from_tree(header["mission"]),
            first_plans=tuple(_plans_of(header, 0)),
            entries=tuple(_without_undone(rows[1:])),
            is_ended="end" in rows[-1],
        )


def _without_undone(rows: Sequence[Tree]) -> list[Tree]:
    """Return the steps and incidents that are left; undoing an incident undoes the steps since."""
    entries: list[Tree] = []
    for row in rows:
        if "undo" in row:
            del entries[max(n for n, entry in enumerate(entries) if "happen" in entry) :]
        elif "end" not in row:
            entries.append(row)
    return entries


@contextmanager
def _refusing_other_content(path: Path) -> Iterator[None]:
    """Refuse a file whose lines hold other things than an autosave has."""
    try:
        yield
    except (AttributeError, KeyError, TypeError, ValueError):
        raise TeamformerError(f"{path}: the file holds what no autosave has", NOT_FOUND) from None


def _read_line(path: Path, number: int, line: str) -> Tree:
    try:
        row = json.loads(line)
    except (ValueError, RecursionError):
        row = None
    if not isinstance(row, dict):
        raise TeamformerError(f"{path}:{number}: this is no line of an autosave", NOT_FOUND)
    return row


def play_again(kept: Kept, start: StartMission) -> LiveMission:
    """Return a mission as it stood when it was cut off; no plan is made again that is in the file.

    Raises TeamformerError where a step comes out as another than it was.
    """
    plans = list(kept.first_plans)
    mission = start(kept.mission, plans)
    with _refusing_other_content(kept.path):
        for entry in kept.entries:
            _play_entry(kept, mission, entry, plans)
    plans.clear()
    return mission


def _play_entry(
    kept: Kept, mission: LiveMission, entry: Tree, plans: list[tuple[float, Plan]]
) -> None:
    """Have a move or an incident come again; `plans` are those that the mission is not to make."""
    at = mission.now + ("step" in entry)
    plans[:] = [row for row in plans if row[0] < at] + list(_plans_of(entry, at))
    if "happen" in entry:
        mission.happen(happening_from_tree(entry["happen"], mission.source))
        return
    told = {key: value for key, value in entry.items() if key != "plans"}
    if _as_read(mission.again(told)) != told:
        when = moment_text(mission.source, max(at, mission.now))
        raise TeamformerError(
            f"{kept.path}: {when} comes out otherwise than it did, so that the mission "
            "cannot go on",
            "use the version of Teamformer that it ran by; a method that plans by the clock "
            "may find another plan",
        )


def _plans_of(entry: Tree, at: float) -> Iterator[tuple[float, Plan]]:
    """Yield the plans of a line with when they were made: at `at`, if it does not say."""
    for tree in entry.get("plans", ()):
        fields = {key: value for key, value in tree.items() if key != "at"}
        yield tree.get("at", at), plan_from_tree(fields)


def _as_read(tree: Tree) -> Any:
    """Return a tree as it is once it was written and read."""
    return json.loads(json.dumps(tree, default=own_number))


def drop_half_line(kept: Kept) -> None:
    """Write the file without a last line that was being written when the server was killed."""
    lines = kept.path.read_text(encoding="utf-8").split("\n")[:-1]
    write_whole(kept.path, "".join(f"{line}\n" for line in lines))


def find_autosave(folder: Path) -> Path:
    """Return the latest autosave in a folder: of the mission that ran last, or put aside last."""
    aside = _put_aside(folder)
    return folder / NAME if (folder / NAME).exists() or not aside else aside[-1]


def put_aside(folder: Path) -> Path | None:
    """Rename the autosave of a mission that was cut off, for another begins; return its new path.

    None if there is none, or nothing had been done.
    """
    path = folder / NAME
    if not path.exists():
        return None
    try:
        kept = read_autosave(path)
        if kept.is_ended or not kept.entries:
            return None
    except TeamformerError:
        pass  # perhaps of another version, which may need it
    aside = _put_aside(folder)
    number = 1 + (_number_of(aside[-1]) if aside else 0)
    target = folder / f"autosave-{number}.jsonl"
    os.replace(path, target)
    return target


def _put_aside(folder: Path) -> Sequence[Path]:
    """Return the autosaves that were put aside, the latest last."""
    found = (path for path in folder.glob("autosave-*.jsonl") if PUT_ASIDE.fullmatch(path.name))
    return sorted(found, key=_number_of)


def _number_of(path: Path) -> int:
    match = PUT_ASIDE.fullmatch(path.name)
    assert match is not None, "it was looked for by that name"
    return int(match[1])
