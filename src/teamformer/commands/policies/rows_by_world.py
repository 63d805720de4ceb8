"""What is measured world by world: in processes, kept line by line, and gone on with."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, closing
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, TypeVar

from teamformer.bench.executors import work_in_processes
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

    Raises TeamformerError where nothing is uncertain in a setting, and where a file in the folder
    holds what is no row.
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
    path = None if asked.folder is None else asked.folder / measurement.file
    known = {} if path is None else _read_rows(path, measurement)
    yield from (known[place] for place in places if place in known)
    missing = [place for place in places if place not in known]
    announce_compiling(is_planned=True, has_shared_plan=True)
    with ExitStack() as stack:
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
    """Return what was measured into a folder before."""
    if not path.exists():
        return {}
    found = {}
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        try:
            row = json.loads(line)
            tried = [measurement.row(**it) for it in row["tried"]]
            found[str(row["setting"]), int(row["world"])] = tried
        except (ValueError, TypeError, KeyError):
            hint = "take the line out, or name another folder with --out"
            message = f"{path}:{number}: this is no row of `bench {measurement.suite}`"
            raise TeamformerError(message, hint) from None
    return found
