"""The description of the live server: what is served, shipped and said of it is what it does."""

from __future__ import annotations

import http.client
import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from live_server import Served, serving, serving_editor, small_mission
from teamformer.base.errors import TeamformerError
from teamformer.files.mission_files import mission_to_tree
from teamformer.live.running.messages import COMMANDS, read_incident, read_message

pytest.importorskip("uvicorn", reason="the extra `live` is not installed")
from teamformer.live.serving.downloads import DOWNLOADS
from teamformer.live.serving.openapi import openapi, openapi_text

client = pytest.importorskip("websockets.sync.client")
validators = pytest.importorskip("jsonschema")

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "reference" / "live-messages.md"


def validator_of(name: str) -> Any:
    """Return what checks messages of a schema of the description."""
    components = {"components": openapi()["components"]}
    schema = components | {"$ref": f"#/components/schemas/{name}"}
    return validators.Draft202012Validator(schema)


@pytest.fixture
def served(tmp_path: Path) -> Iterator[Served]:
    with serving(small_mission(), tmp_path / "out") as server:
        yield server


def fetched(server: Served, path: str, **headers: str) -> tuple[int, bytes]:
    line = http.client.HTTPConnection("127.0.0.1", server.port, timeout=20)
    line.request("GET", path, headers=headers)
    answer = line.getresponse()
    content = answer.read()
    line.close()
    return answer.status, content


def test_what_is_shipped_is_what_is_served(served: Served) -> None:
    assert (ROOT / "live.openapi.json").read_text() == openapi_text()
    status, content = fetched(served, "/openapi.json")
    assert (status, json.loads(content)) == (200, openapi())
    assert fetched(served, "/openapi.json", Host="evil.example")[0] == 403


def test_every_path_is_there_and_every_answer_is_described(served: Served) -> None:
    paths = openapi()["paths"]
    for path in ("/", "/openapi.json", "/download/record.json", "/download/nothing"):
        known = "/download/{name}" if path.startswith("/download") else path
        assert str(fetched(served, path)[0]) in paths[known]["get"]["responses"]
    names = paths["/download/{name}"]["get"]["parameters"][0]["schema"]["enum"]
    assert names == list(DOWNLOADS)


@pytest.mark.parametrize(("schema", "key"), [("FromPage", "do"), ("FromServer", "kind")])
def test_the_prose_and_the_schema_have_the_same_messages(schema: str, key: str) -> None:
    described = [it["title"] for it in openapi()["components"]["schemas"][schema]["oneOf"]]
    text = PAGE.read_text(encoding="utf-8")
    after = text.partition(f'`{{"{key}": ...}}`')[2].partition("\n## ")[0]
    first = re.findall(r"^\| ((?:`\w+`(?:, )?)+) \|", after, re.MULTILINE)
    told = {name for names in first for name in re.findall(r"`(\w+)`", names)} - {key}
    assert set(described) == told
    assert len(described) == len(set(described))
    if key == "do":
        assert told == set(COMMANDS)


GOOD = (
    {"do": "play"},
    {"do": "speed", "speed": 0.1},
    {"do": "happen", "lost": "r1"},
    {"do": "what_if", "weighs": "a", "weight": 2},
    {"do": "happen", "task": {"at": [3, 0], "needs": ["scan"]}},
    {"do": "replan"},
    {"do": "acknowledge", "alert": "robot 1"},
    {"do": "run", "mission": {}},
)
WRONG = (
    {"do": "dance"},
    {},
    {"do": "speed", "speed": 0},
    {"do": "speed"},
    {"do": "happen"},
    {"do": "happen", "weighs": "a"},
    {"do": "happen", "weighs": "a", "weight": 0},
    {"do": "happen", "task": {"needs": ["scan"]}},
    {"do": "replan", "seconds": 121},
    {"do": "open", "name": "a.yaml"},
)


def test_the_schema_takes_what_a_page_may_say_and_nothing_else() -> None:
    said = validator_of("FromPage")
    assert [it for it in GOOD if not said.is_valid(it)] == []
    assert [it for it in WRONG if said.is_valid(it)] == []


@pytest.mark.parametrize("message", [it for it in (*GOOD, *WRONG) if "happen" in it.values()])
def test_the_reader_takes_the_incidents_that_the_schema_takes(message: dict[str, Any]) -> None:
    is_described = validator_of("FromPage").is_valid(message)
    try:
        read_incident(read_message(json.dumps(message)), small_mission())
    except TeamformerError:
        assert not is_described
    else:
        assert is_described


def heard_of(server: Served, *asked: tuple[dict[str, Any], str]) -> list[dict[str, Any]]:
    """Return what a page is told as it asks one thing after another, each until its answer."""
    uri, origin = f"ws://{server.address}/socket", f"http://{server.address}"
    heard = []
    with client.connect(uri, origin=origin) as page:
        for message, answer in asked:
            page.send(json.dumps(message))
            kind = ""
            while kind != answer:
                heard.append(json.loads(page.recv(timeout=20)))
                kind = heard[-1]["kind"]
                quiet = sum(it["kind"] == "here" for it in heard)  # each for 5 s; it may compile
                assert quiet < 24, (message, heard[-3:])
    return heard


def test_what_pages_are_told_is_as_described(served: Served, tmp_path: Path) -> None:
    """By a mission that is stepped, disturbed, weighed, and saved; and by one that is drawn."""
    heard = heard_of(
        served,
        ({"do": "step"}, "step"),
        ({"do": "happen", "task": {"at": [3, 0], "needs": ["scan"]}}, "incident"),
        ({"do": "happen", "lost": "r1"}, "incident"),
        ({"do": "happen", "task": {"at": [3, 1], "needs": ["fly"]}}, "refused"),
        ({"do": "undo"}, "mission"),
        ({"do": "what_if", "lost": "r2"}, "what_if"),
        ({"do": "save"}, "saved"),
    )
    with serving_editor(tmp_path / "drawn") as editor:
        tree = mission_to_tree(small_mission())
        heard += heard_of(
            editor,
            ({"do": "check", "mission": {}}, "checked"),
            ({"do": "new"}, "editor"),
            ({"do": "run", "mission": tree}, "begun"),
        )
    told = validator_of("FromServer")
    for message in heard:
        assert told.is_valid(message), (message["kind"], list(told.iter_errors(message)))
    kinds = {message["kind"] for message in heard}
    assert kinds >= {"mission", "state", "step", "incident", "refused", "what_if", "saved"}
    assert kinds >= {"editor", "checked", "starting", "begun"}


def test_the_client_of_the_page_runs(served: Served, capsys: pytest.CaptureFixture[str]) -> None:
    """It plays the mission to its end, with a robot lost on the way."""
    (code,) = re.findall(r"```py\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    assert 20 <= code.count("\n") <= 30
    exec(compile(code.replace("127.0.0.1:8765", served.address), "client", "exec"), {})
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "small: 3 robots, 3 tasks"
    assert "step 3: robot r1 lost" in lines
    assert lines[-1] == f"completed in step {served.session.mission.steps}"
