"""Ten thousand forged records of missions in steps: what share of each kind is found.

`python -m pytest -s -n 0 -m slow tests/fuzz/test_forgery_table.py` prints the table. Some kinds are
never legal. Of the others one value anywhere under a key is something else, which may be as legal
as what it was; what the record's file tells of itself is left out, as it would give all of these
away.
"""

from __future__ import annotations

import copy
from collections import Counter
from collections.abc import Callable, Iterator
from itertools import count
from typing import Any

import numpy as np
import pytest

from forgeries import FORGERIES
from teamformer.base.errors import TeamformerError
from teamformer.record.files.reading import STEP_KEYS, record_from_tree
from teamformer.record.files.writing import record_to_tree
from teamformer.record.record import Record
from teamformer.record.referee import judge
from test_forged_fields import FORGERIES as FIELDS
from test_forged_fields import play

Tree = dict[str, Any]
Forge = Callable[[Record, np.random.Generator], Record | Tree | None]
"""Returns a forged record, or its tree; None where there is nothing to forge."""

KEYS = ("start", "orders", "plans", "scouts", "heeds", "decisions", "truth", "foresight", "end")


NUMBER, ANY = 10_000, "a value of"


@pytest.mark.slow
def test_forgeries_that_are_never_legal_are_found() -> None:
    tried, found = Counter[str](), Counter[str]()
    rng = np.random.default_rng(47)
    for record in records():
        for name, forge in KINDS.items():
            forged = forge(record, rng)
            if forged is not None:
                tried[name] += 1
                found[name] += is_found(forged)
        if tried.total() >= NUMBER:
            break
    print(*table(tried, found), sep="\n")
    never = [name for name in KINDS if not name.startswith(ANY)]
    assert {name: tried[name] - found[name] for name in never} == dict.fromkeys(never, 0)


def table(tried: Counter[str], found: Counter[str]) -> Iterator[str]:
    """Yield the lines of a table: kinds, how many were tried, and the share that was found."""
    yield "| what is forged | tried | found |\n|---|---|---|"
    kinds = [(name, [name]) for name in KINDS if tried[name]]
    kinds += [("all that is never legal", [name for name in KINDS if not name.startswith(ANY)])]
    kinds += [("all single values", [name for name in KINDS if name.startswith(ANY)])]
    for what, names in kinds:
        of, share = sum(tried[name] for name in names), sum(found[name] for name in names)
        yield f"| {what} | {of} | {share / of:.1%} |"


def records() -> Iterator[Record]:
    """Yield records of every kind of mission, without end."""
    for seed in count(2000):
        for together in play(seed, 2):
            yield from together


def is_found(forged: Record | Tree) -> bool:
    """Say whether a forgery is found, be it that it cannot be read."""
    try:
        record = forged if isinstance(forged, Record) else record_from_tree(forged, "record")
    except TeamformerError:
        return True
    return bool(judge(record).findings)


def tree_of(record: Record) -> Tree:
    """Return the tree of a record without what it tells of itself."""
    return {key: value for key, value in record_to_tree(record).items() if key != "told"}


def of_a_kind(name: str) -> Forge:
    """Return what forges a record as the tests of drawn missions do."""

    def forge(record: Record, rng: np.random.Generator) -> Tree | None:
        tree = tree_of(record)
        forged = FORGERIES[name](lambda strategy: int(rng.integers(120)), copy.deepcopy(tree))
        return None if forged == tree else forged

    return forge


def of_a_field(name: str) -> Forge:
    """Return what forges a field, in one of the places where it can be."""

    def forge(record: Record, rng: np.random.Generator) -> Record | None:
        forged = list(FIELDS[name](record))
        return forged[int(rng.integers(len(forged)))] if forged else None

    return forge


def of_any_value(key: str, in_steps: bool) -> Forge:
    """Return what changes a value somewhere under a key of a record, or of one of its steps."""

    def forge(record: Record, rng: np.random.Generator) -> Tree | None:
        tree = tree_of(record)
        trees = tree["steps"] if in_steps else [tree]
        spots = [spot for part in trees if key in part for spot in _values(part, key)]
        if not spots:
            return None
        where, at = spots[int(rng.integers(len(spots)))]
        where[at] = _another(where[at], rng)
        return tree

    return forge


def _values(where: Any, at: Any) -> Iterator[tuple[Any, Any]]:
    """Yield where each value stands in a tree: the list or mapping, and its place there."""
    if isinstance(where[at], dict | list):
        inside = where[at]
        for key in inside if isinstance(inside, dict) else range(len(inside)):
            yield from _values(inside, key)
    else:
        yield where, at


def _another(value: Any, rng: np.random.Generator) -> Any:
    """Return another value of its kind."""
    if isinstance(value, bool):
        return not value
    if isinstance(value, int | float):
        return value + int(rng.choice((-1, 1)))
    return 0 if value is None else f"{value}x"


KINDS: dict[str, Forge] = {
    **{name: of_a_kind(name) for name in FORGERIES},
    **{f"fields: {name}": of_a_field(name) for name in FIELDS},
    **{f"{ANY} {key}": of_any_value(key, in_steps=False) for key in KEYS},
    **{f"{ANY} {key} of a step": of_any_value(key, in_steps=True) for key in STEP_KEYS},
}
