"""What must not change while code moves: `make behaviour` writes it to `behaviour.txt`.

Each row is what one call came to, in a few words, and a hash of all that it told: who did what
when, plans, bounds, views, rehearsals, and texts of the terminal. A commit that only moves code
leaves the file as it is. Another one says which rows changed, and why.

`python tests/behaviour/behaviour.py run-real` writes only the rows that begin so, to the terminal.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from functools import partial
from multiprocessing import get_context
from pathlib import Path

from calls import bound_row, check_row, drawn_row, plan_row, rehearsal_row, run_row, view_row
from missions import (
    EXAMPLES,
    FAMILIES,
    PAPER,
    REHEARSED,
    SURPRISING,
    TIMED,
    UNCERTAIN,
    read,
    timed,
    world,
)
from terminal import SHOWN, terminal_row

FILE = Path(__file__).parent / "behaviour.txt"

Row = Callable[[], str]

LEARNED = ("teamformer", "teamformer-c4", "teamformer-c4-ppo", "deepset-c4", "gnn-c4-bare")
SCRIPTED = ("heuristic", "join-all", "join-fitting")


def rows() -> Iterator[tuple[str, Row]]:
    """Yield the name of each row and the call that makes the rest of it."""
    for setting in FAMILIES:
        for seed, method in enumerate(("plan", "crews", "heuristic")):
            yield run(setting, seed, method)
    for setting in PAPER:
        for seed, method in enumerate(("plan", "crews", *SCRIPTED, *LEARNED)):
            fitting = method.replace("c4", "c8") if setting.endswith("C8") else method
            yield run(setting, seed % 3, fitting)
    for setting in (*SURPRISING, *UNCERTAIN):
        for seed, method in enumerate(("plan", "crews", "join-fitting")):
            yield run(setting, seed, method)
    for name in EXAMPLES:
        for method in ("plan", "crews", "heuristic", "teamformer"):
            yield f"run {name} {method}", partial(run_row, partial(read, name), 0, method)
        yield f"bound {name}", partial(bound_row, partial(read, name))
        yield f"check {name}", partial(check_row, partial(read, name))
    for setting in (*FAMILIES, *PAPER):
        yield f"draw {setting}", partial(drawn_row, setting)
        yield f"bound {setting}", partial(bound_row, partial(world, setting, 1))
    for setting in (*PAPER, *UNCERTAIN):
        yield f"view {setting}", partial(view_row, partial(world, setting, 4))
    for setting in TIMED:
        for method in ("plan", "reactive"):
            yield f"plan {setting} {method}", partial(plan_row, partial(timed, setting), method)
    for name in REHEARSED:
        for seed in range(3):
            call = partial(rehearsal_row, partial(read, name), seed)
            yield f"rehearse {name} {seed}", call
    for line in SHOWN:
        yield f"terminal {line}", partial(terminal_row, line)


def run(setting: str, seed: int, method: str) -> tuple[str, Row]:
    """Return the row of a drawn mission that is run by a method."""
    mission = partial(world, setting, seed)
    return f"run {setting} {seed} {method}", partial(run_row, mission, seed, method)


def make(row: tuple[str, Row]) -> str:
    """Return a row as text; what is refused is told, too."""
    name, call = row
    return f"{name}: {call()}"


def main() -> None:
    """Write all rows to the file, or those whose names begin so to the terminal."""
    beginning = " ".join(sys.argv[1:])
    wanted = [row for row in rows() if row[0].startswith(beginning)]
    with get_context("spawn").Pool(2) as pool:
        made = pool.imap(make, wanted, chunksize=1)
        if beginning:
            for text in made:
                print(text, flush=True)
        else:
            FILE.write_text("".join(f"{text}\n" for text in made), encoding="utf-8")


if __name__ == "__main__":
    main()
