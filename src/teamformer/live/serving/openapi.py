"""What the server of a live mission offers programs, as OpenAPI 3.1."""

from __future__ import annotations

import json
from typing import Any

from teamformer.live.serving.downloads import DOWNLOADS
from teamformer.live.serving.message_schemas import (
    NUMBER,
    TEXT,
    YES,
    Schema,
    or_none,
    said_by_pages,
    said_by_the_server,
    task_schema,
)

VERSION = "1"
"""Of what is offered; a program that understands it goes on to while this stays."""

TOKEN: Schema = {
    "name": "token",
    "in": "query",
    "description": "needed if the server was started with one; it is in the address it printed",
    "schema": TEXT,
}

ALERT: Schema = {
    "type": "object",
    "properties": {"key": TEXT, "what": TEXT, "why": TEXT, "do": TEXT},
    "required": ["key", "what", "why", "do"],
}


def openapi() -> dict[str, Any]:
    """Return the description of the server's paths, its socket, and what webhooks are sent."""
    return {
        "openapi": "3.1.0",
        "info": {
            "title": "Teamformer: a live mission, or a fleet that is watched",
            "version": VERSION,
            "description": "What `teamformer live` and `teamformer fleet watch` serve.",
        },
        "paths": _paths(),
        "webhooks": {"alert": {"post": _alert_post()}},
        "components": {"schemas": _schemas()},
    }


def openapi_text() -> str:
    """Return the description as JSON."""
    return json.dumps(openapi(), indent=1, ensure_ascii=False) + "\n"


def _paths() -> dict[str, Any]:
    name = {
        "name": "name",
        "in": "path",
        "required": True,
        "schema": {"enum": list(DOWNLOADS)},
    }
    socket = (
        "A WebSocket. A client sends messages of the schema `FromPage` and is sent those of "
        "`FromServer`, one JSON object each."
    )
    return {
        "/": {"get": _get("the page", "text/html", {})},
        "/openapi.json": {"get": _get("this description", "application/json", {})},
        "/download/{name}": {
            "get": _get(
                "a file of the mission as it is now",
                "application/octet-stream",
                {
                    "404": _plain("there is no such file, or no mission runs yet"),
                    "501": _plain("a library for it is not installed"),
                },
                name,
            )
        },
        "/socket": {
            "get": {
                "summary": "the socket of messages",
                "description": socket,
                "parameters": [TOKEN],
                "responses": {"101": {"description": "the connection becomes a WebSocket"}},
            }
        },
    }


def _get(about: str, kind: str, refusals: Schema, *parameters: Schema) -> Schema:
    found = {"description": about, "content": {kind: {"schema": {}}}}
    refused = _plain("another site or name asks, or the token is missing")
    return {
        "summary": about,
        "parameters": [*parameters, TOKEN],
        "responses": {"200": found, "403": refused, **refusals},
    }


def _plain(why: str) -> Schema:
    return {"description": why, "content": {"text/plain": {"schema": TEXT}}}


def _alert_post() -> Schema:
    sent = {"application/json": {"schema": {"$ref": "#/components/schemas/AlertEvent"}}}
    return {
        "summary": "an alert is raised or has ended; sent to the address of --webhook",
        "requestBody": {"content": sent},
        "responses": {
            "2XX": {"description": "taken; any other answer is tried again, three times"}
        },
    }


def _schemas() -> dict[str, Any]:
    told = {"since": or_none(NUMBER), "seconds": NUMBER, "is_acknowledged": YES}
    event = {
        "event": {"enum": ["raised", "ended"]},
        "mission": TEXT,
        "text": TEXT,
        "alert": ALERT,
        "at": {"type": "string", "format": "date-time"},
        "seconds": NUMBER,
    }
    return {
        "FromPage": {"oneOf": said_by_pages()},
        "FromServer": {"oneOf": said_by_the_server()},
        "Alert": ALERT | {"properties": ALERT["properties"] | told},
        "AlertEvent": {"type": "object", "properties": event, "required": list(event)},
        "Task": task_schema(),
    }
