"""What is measured world by world: in processes, kept line by line, and gone on with."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, closing
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, TypeVar

from teamformer.bench.executors import work_in_processes
from teamformer.bench.store import lock_folder, replace_text, set_aside
from teamformer.commands.compiling import announce_compiling
from teamformer.commands.console import Counting, prepare_folder, print_json, say
from teamformer.errors import TeamformerError
from teamformer.scenarios.named_settings import world_of

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

SETTINGS = ("real-needs", "real-places", "sparse-needs", "sparse-places")
"""What is measured if nothing is said: the families of missions in which looking pays."""

Row = TypeVar("Row", bound="DataclassInstance")
Place = tuple[str, int]
"""A setting and the number of a world."""


class Asked(NamedTuple):
    """What to measure: so many worlds of each setting, from a first one on."""

    settings: Sequence[str]
    worlds: int
    first: int
    workers: int
    folder: Path | None


@dataclass(frozen=True)
class Measurement(Generic[Row]):
    """What `bench` calls it, the file that its rows are kept in, and how a world gives rows."""

    suite: str
    file: str
    row: type[Row]
    work: Callable[[str, int], list[Row]]


def measure_worlds(asked: Asked, measurement: Measurement[Row], as_json: bool) -> list[Row] | None:
    """Return the rows of all worlds, printed as JSON if wanted; None if it was interrupted.

    Raises TeamformerError where nothing is uncertain in a setting, and where another benchmark is
    at work in the folder. Lines of its file that are no rows are set aside and measured again.
    """
    for setting in asked.settings:
        if not world_of(setting, asked.first).has_surprises:
            hint = f"use settings such as {', '.join(SETTINGS)}"
            raise TeamformerError(f"in '{setting}' nothing is uncertain", hint)
    if asked.folder is not None:
        prepare_folder(asked.folder)
    found: list[Row] = []
    try:
        for rows in _measure_all(asked, measurement):
            found += rows
            for row in rows if as_json else ():
                print_json(asdict(row))
    except KeyboardInterrupt:
        kept = "; what was tried is kept, run again to go on" if asked.folder else ""
        say(f"interrupted{kept}")
        return None
    return found


def _measure_all(asked: Asked, measurement: Measurement[Row]) -> Iterator[list[Row]]:
    """Yield the rows of each world, measured before or now."""
    places = [
        (setting, world)
        for world in range(asked.first, asked.first + asked.worlds)
        for setting in asked.settings
    ]
    with ExitStack() as stack:
        path = None if asked.folder is None else asked.folder / measurement.file
        if asked.folder is not None:
            stack.callback(os.close, lock_folder(asked.folder))
        known = {} if path is None else _read_rows(path, measurement)
        yield from (known[place] for place in places if place in known)
        missing = [place for place in places if place not in known]
        announce_compiling(is_planned=True, has_shared_plan=True)
        file = None if path is None else stack.enter_context(path.open("a", encoding="utf-8"))
        counting = stack.enter_context(Counting("worlds"))
        work = work_in_processes(partial(_measure_at, measurement.work), missing, asked.workers)
        for done, (place, rows) in enumerate(stack.enter_context(closing(work)), 1):
            if file is not None:
                setting, world = place
                kept = {"setting": setting, "world": world, "tried": [asdict(row) for row in rows]}
                print(json.dumps(kept), file=file, flush=True)
            yield rows
            counting.update(done, len(missing))


def _measure_at(work: Callable[[str, int], list[Any]], place: Place) -> tuple[Place, list[Any]]:
    return place, work(*place)


def _read_rows(path: Path, measurement: Measurement[Row]) -> dict[Place, list[Row]]:
    """Return what was measured into a folder before; lines that are no rows are set aside."""
    if not path.exists():
        return {}
    text = path.read_bytes().decode("utf-8", errors="replace")
    found: dict[Place, list[Row]] = {}
    kept, broken = [], []
    for number, line in enumerate(text.split("\n"), 1):
        try:
            row = json.loads(line)
            tried = [measurement.row(**it) for it in row["tried"]]
            found[str(row["setting"]), int(row["world"])] = tried
            kept.append(f"{line}\n")
        except (ValueError, TypeError, KeyError):
            broken += [(number, line)] if line else []
    if broken:
        set_aside(path, broken, say)
    if broken or not text.endswith("\n"):
        replace_text(path, "".join(kept))
    return found
