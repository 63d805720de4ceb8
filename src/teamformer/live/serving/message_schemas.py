"""The messages of the socket as JSON Schema: what a page may say, and what it is told."""

from __future__ import annotations

from typing import Any

from teamformer.files.schema import mission_schema
from teamformer.live.running.messages import HIGHEST_RATE, LEAST_RATE, LONGEST_SEARCH
from teamformer.mission.keys.task_keys import LARGEST_WEIGHT, SMALLEST_WEIGHT

Schema = dict[str, Any]

TEXT: Schema = {"type": "string"}
NUMBER: Schema = {"type": "number"}
STEPS: Schema = {"type": "integer", "minimum": 0}
TIME: Schema = {"type": "number", "minimum": 0}  # steps, or units of continuous time
YES: Schema = {"type": "boolean"}
ANY: Schema = {}
TREE: Schema = {"type": "object"}


def list_of(items: Schema) -> Schema:
    """Return the schema of a list."""
    return {"type": "array", "items": items}


def or_none(schema: Schema) -> Schema:
    """Return the schema of a value that may be null."""
    return {"anyOf": [schema, {"type": "null"}]}


def message(key: str, name: str, about: str, needs: Schema, may: Schema | None = None) -> Schema:
    """Return the schema of a message whose `key` is a name, with what it must and may have."""
    return {
        "title": name,
        "description": about,
        "type": "object",
        "properties": {key: {"const": name}, **needs, **(may or {})},
        "required": [key, *needs],
    }


DRAWN: Schema = {"id": TEXT, "after": TEXT}
INCIDENT: Schema = {
    "oneOf": [
        {"required": ["lost"], "properties": {"lost": TEXT}},
        {"required": ["back"], "properties": {"back": TEXT}},
        {"required": ["cancelled"], "properties": {"cancelled": TEXT}},
        {
            "required": ["weighs", "weight"],
            "properties": {
                "weighs": TEXT,
                "weight": {"type": "number", "minimum": SMALLEST_WEIGHT, "maximum": LARGEST_WEIGHT},
            },
        },
        {
            "required": ["task"],
            "properties": {"task": {"$ref": "#/components/schemas/Task"}},
        },
    ]
}


def said_by_pages() -> list[Schema]:
    """Return the messages of a page, `{"do": ...}`, in the order of the commands."""
    seconds = {"type": "number", "minimum": 0, "maximum": LONGEST_SEARCH, "default": 10}
    speed = {"type": "number", "minimum": LEAST_RATE, "maximum": HIGHEST_RATE}
    files = {"beside": {"type": "object", "additionalProperties": TEXT}}
    drawn = {"mission": ANY} | DRAWN
    plain = {
        "play": "start the mission, or go on with it",
        "pause": "pause the mission",
        "step": "make one step; in continuous time go on until something happens",
        "stop": "end what this page asked by what_if, and the search for a plan",
        "take_over": "follow the plan that was found last",
        "undo": "go back to just before the latest incident",
        "restart": "go back to the start of the mission",
        "edit": "end the mission and show its drawing",
        "new": "empty the drawing",
    }
    return [
        *(message("do", name, about, {}) for name, about in plain.items()),
        message("do", "speed", "set the steps, or units of time, per second", {"speed": speed}),
        message("do", "happen", "make an incident happen", {}) | INCIDENT,
        message("do", "what_if", "say what an incident would cost or gain", {}) | INCIDENT,
        message("do", "replan", "search for a better plan", {}, {"seconds": seconds}),
        message("do", "save", "write the record and the mission", {}, {"name": TEXT} | drawn),
        message("do", "acknowledge", "acknowledge an alert of a fleet", {"alert": TEXT}),
        message("do", "check", "say what is wrong with a drawing", {"mission": ANY}, DRAWN),
        message("do", "open", "draw a file", {"name": TEXT, "text": TEXT}, files),
        message("do", "run", "run the mission that is drawn", {"mission": ANY}, DRAWN),
    ]


FORECAST: Schema = {"status": TEXT}
STATE: Schema = {
    "is_playing": YES,
    "speed": NUMBER,
    "watchers": STEPS,
    "incidents": list_of(list_of(ANY)),
}
MAY_BE_OF_A_STATE: Schema = {
    "id": TEXT,
    "now": TIME,
    "undo_to": or_none(TIME),
    "leaving": list_of(TEXT),
    "saved_at": or_none(TIME),
    "planning": TEXT,
    "has_editor": YES,
    "is_fleet": YES,
    "is_heard": YES,
    "is_over": YES,
    "alerts": list_of({"$ref": "#/components/schemas/Alert"}),
}


def said_by_the_server() -> list[Schema]:
    """Return what pages are told, `{"kind": ...}`."""
    recorded = {"record": TREE} | STATE
    problem = {"type": "object", "properties": {"where": list_of(ANY), "message": TEXT}}
    outlook = {"steps": NUMBER, "done_at": list_of(or_none(NUMBER))}
    compared = {"without": TREE, "at": TIME}
    return [
        *_of_drawings(problem),
        message("kind", "begun", "load the page again: a mission has begun or ended", {}),
        message("kind", "mission", "the whole record so far", recorded, MAY_BE_OF_A_STATE | TEXTED),
        message("kind", "state", "how the mission stands", STATE, MAY_BE_OF_A_STATE),
        message(
            *("kind", "step", "one step, as in the record, and what is told of it"),
            {"at": STEPS, "step": TREE, "told": TREE},
        ),
        message(
            *("kind", "moment", "continuous time that has passed, and what has happened in it"),
            {"now": TIME, "from": STEPS, "events": list_of(list_of(ANY))},
            {"told": TREE, "end": TREE},
        ),
        message(
            *("kind", "incident", "something has happened"),
            {"text": TEXT} | recorded,
            {"is_loss": YES} | MAY_BE_OF_A_STATE,
        ),
        message("kind", "bound", "no plan takes fewer steps", {"lower_bound": TIME}),
        message("kind", "forecast", "when the mission will end", FORECAST, outlook),
        message(
            "kind",
            "what_if",
            "when it would end with an incident",
            FORECAST | compared,
            {"is_planned": YES},
        ),
        message(
            "kind",
            "luck",
            "how much of that may be luck of the search",
            {"steps": NUMBER, "is_luck": YES},
        ),
        message("kind", "stopped", "what was asked for has ended", {}),
        message("kind", "searching", "a plan is being searched for", {"seconds": NUMBER}),
        message("kind", "offer", "a plan was found", FORECAST | compared | TEXTED),
        message("kind", "here", "the server is there", {}),
        message("kind", "warning", "the autosave cannot be kept", TEXTED),
        message("kind", "saved", "files were written", {"paths": list_of(TEXT)}, {"note": TEXT}),
        message(
            *("kind", "refused", "something was not done, and why"),
            TEXTED,
            {"keys": list_of(TEXT), "is_weighed": YES},
        ),
    ]


TEXTED: Schema = {"text": TEXT}


def _of_drawings(problem: Schema) -> list[Schema]:
    drawing = {"mission": ANY, "file": TEXT, "id": TEXT}
    checked = {"problems": list_of(problem), "id": or_none(TEXT)}
    return [
        message("kind", "editor", "what is drawn, by this page or another", drawing),
        message("kind", "checked", "what is wrong with a drawing", checked),
        message("kind", "starting", "a mission is made ready", {"mission": ANY} | TEXTED),
    ]


def task_schema() -> Schema:
    """Return the schema of a task of a mission file; one that is added needs no name."""
    task: Schema = mission_schema()["properties"]["tasks"]["items"]
    return task
