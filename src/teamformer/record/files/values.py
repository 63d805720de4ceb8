"""Values of a record's file, each checked as it is read."""

from __future__ import annotations

import reprlib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from teamformer.mission.keys.kinds import LARGEST_NUMBER

LARGEST_COUNT = 2**53
"""Which every reader of JSON keeps exact, the page's too."""


class DamageError(Exception):
    """Something in a record that is not what it should be."""


@contextmanager
def inside(where: str) -> Iterator[None]:
    """Say where in the record the damage is."""
    try:
        yield
    except DamageError as damage:
        raise DamageError(f"{where}: {damage}") from None


def check_keys(tree: Any, known: Sequence[str], needed: Sequence[str] = ()) -> None:
    """Refuse a tree that is no mapping, or has keys that mean nothing or too few."""
    if not isinstance(tree, dict):
        raise DamageError(f"{short(tree)} stands where a mapping belongs")
    for key in tree:
        if key not in known:
            raise DamageError(f"the key {short(key)} means nothing; known are {', '.join(known)}")
    for key in needed:
        if key not in tree:
            raise DamageError(f"the key '{key}' is missing")


def rows_of(values: Any, width: int, least: int | None = None) -> Iterator[list[Any]]:
    """Yield the rows of a list, each of so many values, or of at least some of these."""
    least = width if least is None else least
    for row in list_of(values):
        if not isinstance(row, list) or not least <= len(row) <= width:
            size = width if least == width else f"{least} to {width}"
            raise DamageError(f"{short(row)} stands where a list of {size} belongs")
        yield row


def list_of(values: Any) -> list[Any]:
    """Return a list."""
    if not isinstance(values, list):
        raise DamageError(f"{short(values)} stands where a list belongs")
    return values


def numbers_below(values: Any, limit: int) -> tuple[int, ...]:
    """Return a list of numbers, each from 0 to below a limit."""
    return tuple(number_below(value, limit) for value in list_of(values))


def number_below(value: Any, limit: int) -> int:
    """Return a number from 0 to below a limit."""
    if not 0 <= number_of(value) < limit:
        raise DamageError(f"{short(value)} stands where a number from 0 to {limit - 1} belongs")
    return int(value)


def count_of(value: Any) -> int:
    """Return a number that is 0 or more."""
    if number_of(value) < 0:
        raise DamageError(f"{short(value)} stands where 0 or more belongs")
    return int(value)


def amount_of(value: Any) -> float:
    """Return how much of a capability there is; `Mission` checks the rest."""
    return metres(value) if isinstance(value, float) else count_of(value)


def time_of(value: Any) -> float:
    """Return a moment or a span in continuous time: 0 or more, a fraction too."""
    if metres(value) < 0:
        raise DamageError(f"{short(value)} stands where 0 or more belongs")
    return float(value)


def number_of(value: Any) -> int:
    """Return a whole number that counts something or says where something is."""
    if not abs(whole_number(value)) <= LARGEST_COUNT:
        raise DamageError(f"{short(value)} is more than a record can count")
    return int(value)


def whole_number(value: Any) -> int:
    """Return a whole number of any size."""
    if not is_whole(value):
        raise DamageError(f"{short(value)} stands where a whole number belongs")
    return int(value)


def metres(value: Any) -> float:
    """Return a coordinate in a plane."""
    if type(value) not in (int, float) or not abs(value) <= LARGEST_NUMBER:  # NaN too
        raise DamageError(f"{short(value)} stands where a number belongs")
    return float(value)


def is_whole(value: Any) -> bool:
    """Say whether this is a whole number; True, which is an int to Python, is none."""
    return type(value) is int


def text_of(value: Any) -> str:
    """Return a text."""
    if not isinstance(value, str):
        raise DamageError(f"{short(value)} stands where a text belongs")
    return value


def short(value: Any) -> str:
    """Return a value as an error can show it."""
    return reprlib.repr(value)
