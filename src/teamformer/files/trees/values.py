"""Reading what stands under keys, by kind (`mission/keys/kinds.py`)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

from teamformer.files.trees.world import read_at
from teamformer.files.yaml.reader import Where
from teamformer.files.yaml.tree_reader import Reader, name_of
from teamformer.files.yaml.words import describe, shorten
from teamformer.mission.keys import kinds
from teamformer.mission.keys.key import Key
from teamformer.mission.model import Arrivals, Breakdown, Delays, World
from teamformer.mission.parts.charging import Battery, Charger
from teamformer.mission.parts.roads import Roads
from teamformer.mission.parts.zones import Zone

MADE: Mapping[str, Callable[..., Any]] = {
    made.__name__: made for made in (Arrivals, Battery, Breakdown, Charger, Delays, Zone)
}
"""What parts become, by name."""


@dataclass(frozen=True)
class Given:
    """What has been read of a mission before: its world, its time if it says, robots by name."""

    world: World
    time: object = None
    named: Mapping[str, tuple[int, ...]] = field(default_factory=dict)


def read_part(
    reader: Reader, where: Where, value: Any, keys: Sequence[Key], given: Given
) -> dict[str, Any]:
    """Return what stands under the keys of a mapping, by field of the model.

    What must be there and is not has been refused; something harmless stands in for it.
    """
    known, is_required, lacking = _by_name(tuple(keys))
    return lacking | {
        known[name].field: read(known[name].kind, reader, (*where, name), part, given)
        for name, part in reader.mapping(where, value, is_required).items()
    }


@lru_cache(maxsize=64)
def _by_name(keys: tuple[Key, ...]) -> tuple[dict[str, Key], dict[str, bool], dict[str, Any]]:
    """Return keys by name, whether each must be there, and by field what stands in for those."""
    lacking = {key.field: stand_in(key.kind) for key in keys if key.is_required}
    required = {key.name: key.is_required for key in keys}
    return {key.name: key for key in keys}, required, lacking


def stand_in(kind: kinds.Kind) -> Any:
    """Return something harmless of a kind, for what must be there and is not."""
    match kind:
        case kinds.Place():
            return (0, 0)
        case kinds.Counts():
            return {}
        case kinds.Names() | kinds.KeyedParts():
            return []
    return 0


def read(kind: kinds.Kind, reader: Reader, where: Where, value: Any, given: Given) -> Any:
    """Return what a value of some kind means; what is wrong with it is noted in the reader."""
    span = reader.number if given.time == "continuous" else reader.whole
    match kind:
        case kinds.Text():
            return reader.text(where, value, kind.longest)
        case kinds.Number():
            return reader.number(where, value, kind.can_be_infinite)
        case kinds.Whole(is_checked_later=True):
            return reader.whole(where, value)
        case kinds.Whole():
            return reader.whole(where, value, kind.least, kind.most)
        case kinds.Time():
            return span(where, value)
        case kinds.Range():
            return _pair(reader, where, value, kind.remedy, span)
        case kinds.Window():
            return _pair(reader, where, value, f"write it as {kind.form}", reader.number)
        case kinds.Counts():
            return reader.counts(where, value)
        case kinds.Names():
            return tuple(reader.names(where, value))
        case kinds.Place():
            return read_at(reader, where, value, given.world)
        case kinds.OneOf():
            return reader.word(value)
        case kinds.Truth():
            return reader.truth(where, value)
        case kinds.Chances():
            form = "a mapping to probabilities, such as {weld: 0.4}"
            return _read_named(reader, where, value, kinds.Number(0, 1), form, given)
        case kinds.StartLinks():
            gap, form = kinds.Window("[least, most]"), "{TASK: [least, most]}"
            gaps = _read_named(reader, where, value, gap, form, given)
            return {name: gap for name, gap in gaps.items() if gap is not None}
        case kinds.Moments():
            if given.time == "continuous":
                return [reader.number(at, moment) for at, moment in _entries(where, value)]
            return [reader.whole(at, step, most=kind.most) for at, step in _entries(where, value)]
        case kinds.KeyedPart():
            return _read_keyed(kind, reader, where, value, given)
        case kinds.NamedParts():
            return _read_named_parts(kind, reader, where, value, given)
        case kinds.Moves():
            return _read_moves(kind, reader, where, value, given)
        case kinds.Either():
            chosen = kind.listed if isinstance(value, list) else kind.plain
            if isinstance(chosen, kinds.OneOf) and isinstance(given.world, Roads):
                chosen = chosen if value in chosen.choices else kind.listed  # the name of a place
            return read(chosen, reader, where, value, given)
    return _read_list(kind, reader, where, value, given)


def _read_list(kind: kinds.Kind, reader: Reader, where: Where, value: Any, given: Given) -> Any:
    """Return what a list of some kind means."""
    match kind:
        case kinds.Shifts():
            if value == []:
                reader.refuse(where, "shifts names no time; write [[begin, end]], or drop it")
            windows = _read_each(kinds.Window(), reader, where, value, given)
            return tuple(window for window in windows if window is not None)
        case kinds.RobotNames():
            if value == []:
                reader.refuse(where, f"{where[-1]} names no robot; name one, or drop it")
            return _read_robots(reader, where, value, given)
        case kinds.TeamLists():
            teams = enumerate(reader.sequence(where, value))
            return tuple(_read_robots(reader, (*where, n), team, given) for n, team in teams)
        case kinds.Places():
            if value == []:
                reader.refuse(where, f"{name_of(where)} is an empty list; name a place, or drop it")
            return _read_each(kinds.Place(), reader, where, value, given)
        case kinds.KeyedParts():
            if value == []:
                reader.refuse(where, f"{name_of(where)} is an empty list; write one, or drop it")
            one = kinds.KeyedPart(kind.keys, kind.makes)
            return _read_each(one, reader, where, value, given)
    raise NotImplementedError(kind)


def _read_each(
    kind: kinds.Kind, reader: Reader, where: Where, value: Any, given: Given
) -> tuple[Any, ...]:
    """Return the entries of a list, all of one kind."""
    entries = enumerate(reader.sequence(where, value))
    return tuple(read(kind, reader, (*where, number), one, given) for number, one in entries)


def _entries(where: Where, value: Any) -> list[tuple[Where, Any]]:
    """Return the entries of a list, or what stands alone, with their places."""
    if not isinstance(value, list):
        return [(where, value)]
    return [((*where, entry), one) for entry, one in enumerate(value)]


def _pair(
    reader: Reader, where: Where, value: Any, remedy: str, read_one: Callable[[Where, Any], float]
) -> tuple[float, float] | None:
    """Return two times, or None for what are none; `remedy` says how they are written."""
    pair = reader.pair(where, value, remedy)
    if pair is None:
        return None
    first, second = (read_one((*where, part), time) for part, time in enumerate(pair))
    return first, second


def _read_named(
    reader: Reader, where: Where, value: Any, kind: kinds.Kind, form: str, given: Given
) -> dict[str, Any]:
    """Return values of a kind, by name."""
    if not isinstance(value, dict):
        reader.refuse(where, f"{name_of(where)} is {describe(value)}; write {form}")
        return {}
    return {
        reader.text((*where, name), name): read(kind, reader, (*where, name), part, given)
        for name, part in value.items()
    }


def _read_robots(reader: Reader, where: Where, value: Any, given: Given) -> tuple[int, ...]:
    """Return the robots in a list of names; those that are none are refused."""
    found: list[int] = []
    for entry, name in enumerate(reader.names(where, value)):
        if name not in given.named and name != "?":
            message = f"there is no robot '{shorten(name)}'; write the name of one"
            reader.refuse((*where, entry), message)
        found += given.named.get(name, ())
    return tuple(found)


def _read_moves(kind: kinds.Moves, reader: Reader, where: Where, value: Any, given: Given) -> str:
    word = reader.text(where, value)
    if word not in kind.choices and not isinstance(given.world, Roads):
        reader.refuse(where, f"{name_of(where)} is '{word}'; write {' or '.join(kind.choices)}")
    return word


def _read_keyed(
    kind: kinds.KeyedPart, reader: Reader, where: Where, value: Any, given: Given
) -> Any:
    """Return what a mapping with keys of its own becomes, or the one value that stands for it."""
    if kind.alone and not isinstance(value, dict):
        [key] = [key for key in kind.keys if key.name == kind.alone]
        said = {key.field: read(key.kind, reader, where, value, given)}
    else:
        said = read_part(reader, where, value, kind.keys, given)
    return MADE[kind.makes](**said) if kind.makes else said


def _read_named_parts(
    kind: kinds.NamedParts, reader: Reader, where: Where, value: Any, given: Given
) -> tuple[Any, ...]:
    """Return what mappings by name become, in the order of their names."""
    if not isinstance(value, dict) or not value:
        said = "an empty mapping" if value == {} else describe(value)
        message = f"{name_of(where)} is {said}; write {{name: {{...}}}}, or drop it"
        reader.refuse(where, message)
        return ()
    return tuple(
        MADE[kind.makes](
            name=reader.text((*where, name), name),
            **read_part(reader, (*where, name), part, kind.keys, given),
        )
        for name, part in sorted(value.items(), key=lambda part: str(part[0]))
    )
