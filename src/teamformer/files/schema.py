"""The JSON Schema of the mission file, by which editors complete keys and underline mistakes."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from teamformer.mission.keys import kinds
from teamformer.mission.keys.key import FIRST_VERSION, Key, plain
from teamformer.mission.keys.mission_keys import MISSION_KEYS

Schema = dict[str, Any]

NAME: Schema = {"type": "string", "minLength": 1, "maxLength": kinds.LONGEST_TEXT}
COUNT: Schema = {"type": "number", "exclusiveMinimum": 0, "maximum": kinds.LARGEST_COUNT}
TIME: Schema = {"type": "number", "minimum": 0, "maximum": kinds.LARGEST_NUMBER}
FINITE: Schema = {
    "type": "number",
    "minimum": -kinds.LARGEST_NUMBER,
    "maximum": kinds.LARGEST_NUMBER,
}


def schema_text() -> str:
    """Return the schema as JSON."""
    return json.dumps(mission_schema(), indent=2, ensure_ascii=False) + "\n"


def mission_schema() -> Schema:
    """Return the schema of the mission file, draft 2020-12."""
    head = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Teamformer mission file",
        "description": "A world, robots with their places and capabilities, and tasks.",
    }
    return head | object_of(MISSION_KEYS)


def object_of(keys: Sequence[Key]) -> Schema:
    """Return the schema of a mapping with these keys and no others."""
    required = [key.name for key in keys if key.is_required]
    return {
        "type": "object",
        "properties": {key.name: schema_of_key(key) for key in keys},
        **({"required": required} if required else {}),
        "additionalProperties": False,
    }


def schema_of_key(key: Key) -> Schema:
    """Return the schema of what stands under a key, with what it means, its default, an example."""
    about: Schema = {"description": key.in_words}
    if key.since != FIRST_VERSION:
        about["description"] += f" (since {key.since})"
    if key.without:
        about["description"] += f". If left out: {plain(key.without)}"
    elif not key.is_required and key.default is not None:
        about["default"] = key.default
    if key.example is not None:
        about["examples"] = [key.example]
    return about | schema_of(key.kind)


def schema_of(kind: kinds.Kind) -> Schema:
    """Return the schema of a kind."""
    match kind:
        case kinds.Text():
            return NAME | {"maxLength": kind.longest}
        case kinds.Number() | kinds.Whole():
            return _of_number(kind)
        case kinds.Time():
            return _of_number(kinds.Number(0, is_above=kind.is_above))
        case kinds.Moments():
            step = _of_number(kinds.Number(0, kind.most, is_above=True))
            return {"anyOf": [step, {"type": "array", "items": step}]}
        case kinds.Range():
            return _pair(TIME)
        case kinds.Window():
            return _pair(TIME)
        case kinds.Shifts():
            return {"type": "array", "items": _pair(TIME), "minItems": 1}
        case kinds.StartLinks():
            return {"type": "object", "additionalProperties": _pair(TIME)}
        case kinds.Counts():
            names = {"type": "array", "items": NAME, "minItems": 1, "uniqueItems": True}
            counts = {"type": "object", "additionalProperties": COUNT, "minProperties": 1}
            return {"anyOf": [names, counts]}
        case kinds.Chances():
            return {"type": "object", "additionalProperties": _of_number(kinds.Number(0, 1))}
        case kinds.Names():
            return {"type": "array", "items": NAME, "uniqueItems": True}
        case kinds.RobotNames():
            return {"type": "array", "items": NAME, "minItems": 1}
        case kinds.TeamLists():
            return {"type": "array", "items": schema_of(kinds.RobotNames())}
        case kinds.Places():
            return {"type": "array", "items": schema_of(kinds.Place()), "minItems": 1}
        case kinds.NamedParts():
            part = object_of(kind.keys)
            return {"type": "object", "additionalProperties": part, "minProperties": 1}
        case kinds.Place():
            return {"anyOf": [_pair(FINITE), NAME]}
        case kinds.OneOf():
            return {"enum": list(kind.choices)}
        case kinds.Truth():
            return {"type": "boolean"}
        case kinds.Moves():
            return NAME | {"examples": list(kind.choices)}
        case kinds.KeyedPart():
            return _of_part(kind)
        case kinds.KeyedParts():
            return {"type": "array", "items": object_of(kind.keys), "minItems": 1}
        case kinds.Either():
            return {"anyOf": [schema_of(kind.plain), schema_of(kind.listed)]}
        case kinds.Sides():
            return _pair(_of_number(kind.of))
        case kinds.Rows():
            text = {"type": "string"}
            return {"anyOf": [{"type": "array", "items": text, "minItems": 1}, text]}
        case kinds.Tables():
            text = {"type": "string"}
            tables = {"type": "object", "additionalProperties": text, "minProperties": 1}
            return {"anyOf": [text, tables]}
        case kinds.Origin():
            return {"type": "array", "items": FINITE, "minItems": 2, "maxItems": 3}
        case kinds.Forms():
            return {"oneOf": [object_of(keys) for keys in kind.keys.values()]}


def _pair(of: Schema) -> Schema:
    return {"type": "array", "items": of, "minItems": 2, "maxItems": 2}


def _of_number(kind: kinds.Number | kinds.Whole) -> Schema:
    """Return the schema of a number within bounds."""
    least = -kinds.LARGEST_NUMBER if kind.least is None else kind.least
    if isinstance(kind, kinds.Whole):
        return {"type": "integer", "minimum": least, "maximum": kind.most}
    if kind.can_be_infinite:
        return {"anyOf": [{"type": "number", "minimum": least}, {"const": kinds.INFINITE}]}
    return {
        "type": "number",
        "exclusiveMinimum" if kind.is_above else "minimum": least,
        "exclusiveMaximum" if kind.is_below else "maximum": kind.most,
    }


def _of_part(kind: kinds.KeyedPart) -> Schema:
    """Return the schema of a mapping, or of the one value that may stand for it."""
    whole = object_of(kind.keys)
    if not kind.keys[0].is_required:
        whole["minProperties"] = 1
    alone = [schema_of(key.kind) for key in kind.keys if key.name == kind.alone]
    return {"anyOf": [*alone, whole]} if alone else whole
