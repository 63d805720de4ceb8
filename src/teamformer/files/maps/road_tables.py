"""Roads from tables with commas: a row of names, then for each place its name and its times.

```
from, depot, ward, lab
depot, 0, 4, 7.5
ward, 5, 0, 3
lab, 7, , 0
```

A cell that is empty, or `inf`, says that no way leads there directly.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Sequence
from io import StringIO

from teamformer.base.errors import TeamformerError
from teamformer.files.yaml.words import shorten
from teamformer.mission.keys.kinds import LONGEST_TEXT
from teamformer.mission.parts.roads import Roads, Rows, is_way

LARGEST_FILE = 20_000_000  # bytes

NO_WAY = ("", ".inf")  # besides all that Python reads as infinity

Line = Callable[[int], str]
"""Names a line of a table for people."""


def parse_times(text: str, line: Line) -> tuple[tuple[str, ...], Rows]:
    """Return the places of a table and the times between them, (from, to).

    Raises `TeamformerError` with the line and a remedy.
    """
    try:
        reader = csv.reader(StringIO(text), skipinitialspace=True, strict=True)
        table = [(reader.line_num, [cell.strip() for cell in row]) for row in reader if any(row)]
    except csv.Error as error:
        what = f"{line(1)} this is no table with commas: {error}"
        raise TeamformerError(what, "mend its quotes") from None
    if not table:
        raise TeamformerError(
            f"{line(1)} the table is empty", "write a row of names, then a row for each place"
        )
    places = _read_places(table[0], line)
    rows = [_read_row(places, row, at, line) for at, row in enumerate(table[1:])]
    if len(rows) < len(places):
        what = f"{line(table[-1][0])} the table is not square: there is no row of"
        raise TeamformerError(f"{what} '{places[len(rows)]}'", "add it, or drop its column")
    return places, tuple(rows)


def write_times(roads: Roads, mover: str) -> str:
    """Return the times of a mover as a table."""
    text = StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["from", *roads.places])
    for name, row in zip(roads.places, roads.times[mover], strict=True):
        writer.writerow([name, *("" if time == math.inf else f"{time:.15g}" for time in row)])
    return text.getvalue()


def _read_places(first: tuple[int, list[str]], line: Line) -> tuple[str, ...]:
    number, (_, *names) = first
    where, seen = line(number), set[str]()
    if not names:
        what, remedy = "the first row names no places", "write a name for each column"
        raise TeamformerError(f"{where} {what}", f"{remedy}, after a cell for the row's own name")
    for column, name in enumerate(names, 1):
        if not name or len(name) > LONGEST_TEXT or not name.isprintable():
            what = f"the name of column {column} is empty or cannot be printed"
            if len(name) > LONGEST_TEXT:
                what = f"the name of column {column} has more than {LONGEST_TEXT} letters"
            raise TeamformerError(f"{where} {what}", "write another one")
        if name in seen:
            raise TeamformerError(f"{where} the place '{name}' stands twice", "rename one")
        seen.add(name)
    return tuple(names)


def _read_row(
    places: Sequence[str], row: tuple[int, list[str]], at: int, line: Line
) -> tuple[float, ...]:
    number, (name, *cells) = row
    where = line(number)
    if at >= len(places):
        what = f"the table is not square: the row of '{shorten(name)}' is one too many"
        raise TeamformerError(f"{where} {what}", "drop it, or add a column")
    if name != places[at]:
        what = f"this row is of '{shorten(name)}', but column {at + 1} is of '{places[at]}'"
        raise TeamformerError(f"{where} {what}", "name rows and columns alike, in one order")
    if len(cells) != len(places):
        what = f"the table is not square: the row of '{shorten(name)}' has {len(cells)} times"
        raise TeamformerError(f"{where} {what}", f"write one for each of the {len(places)} places")
    return tuple(
        _read_time(cell, f"{where} the time from '{name}' to '{to}'")
        for cell, to in zip(cells, places, strict=True)
    )


def _read_time(cell: str, what: str) -> float:
    remedy = "write 0 to 1e9, or leave it empty where no way leads there"
    try:
        time = math.inf if cell in NO_WAY else float(cell)
    except ValueError:
        raise TeamformerError(f"{what} is '{cell[:40]}'", remedy) from None
    if not is_way(time):
        raise TeamformerError(f"{what} is {time:g}", remedy)
    return time
