"""The server of the Model Context Protocol, asked by the official client as the page shows it."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("mcp")
import anyio
from mcp import Client, StdioServerParameters
from mcp.client.stdio import stdio_client

from loops import run_apart
from teamformer.trials.mcp.workbench import READING, TOOLS

PAGE = Path(__file__).parents[2] / "docs" / "how-to" / "mcp.md"
SERVER = ("-m", "teamformer.cli", "mcp", "--folder")
ASKED = re.compile(
    r"`(\w+)` is asked, and answers:\n\n```json\n(.*?)```\n\n```json\n(.*?)```", re.DOTALL
)


def client_of(folder: Path) -> Client:
    command = StdioServerParameters(
        command=sys.executable, args=[*SERVER, str(folder)], env=dict(os.environ)
    )
    return Client(stdio_client(command))


async def ask(client: Client, tool: str, arguments: dict[str, Any]) -> Any:
    answer = await client.call_tool(tool, arguments)
    assert not answer.is_error, answer.content
    return answer.structured_content


def test_the_conversation_of_the_page(tmp_path: Path) -> None:
    """From twelve lines with a slip to a mission that is legal, explained, and then faster."""
    page = PAGE.read_text(encoding="utf-8")
    (mission,) = re.findall(r"```yaml\n(.*?)```", page, re.DOTALL)
    assert mission.count("\n") == 12
    texts = {
        "<the text above>": mission,
        "<the text above, with needs>": mission.replace(" need:", " needs:"),
    }
    answers: list[tuple[str, Any]] = []

    async def talk() -> None:
        async with client_of(tmp_path) as client:
            for tool, asked, _ in ASKED.findall(page):
                arguments = json.loads(asked)
                if "mission" in arguments:
                    arguments["mission"] = texts[arguments["mission"]]
                answers.append((tool, await ask(client, tool, arguments)))

    run_apart(talk())
    assert answers == [(tool, json.loads(shown)) for tool, _, shown in ASKED.findall(page)]
    before, after = (answer for tool, answer in answers if tool == "run_mission")
    assert before["legal"]
    assert after["legal"]
    assert after["makespan"] < before["makespan"]
    assert (tmp_path / "both.html").stat().st_size > 10_000


def test_what_can_be_read_before_a_mission_is_drawn_up(tmp_path: Path) -> None:
    async def talk() -> None:
        async with client_of(tmp_path) as client:
            told = {str(it.uri) for it in (await client.list_resources()).resources}
            assert "teamformer://examples/warehouse" in told
            for uri, has in {
                "teamformer://schema": '"$schema"',
                "teamformer://mission-file": "# The mission file",
                "teamformer://methods": "heuristic: ",
            }.items():
                (content,) = (await client.read_resource(uri)).contents
                assert has in getattr(content, "text", "")
            for uri in sorted(name for name in told if "/examples/" in name):
                (content,) = (await client.read_resource(uri)).contents
                text = getattr(content, "text", "")
                if "map:" not in text:  # which is a file beside it
                    file = {"file": "it.yaml", "mission": text, "replace": True}
                    assert (await ask(client, "write_mission", file))["written"], uri

    run_apart(talk())


def test_a_client_knows_which_tools_write(tmp_path: Path) -> None:
    async def talk() -> None:
        async with client_of(tmp_path) as client:
            tools = (await client.list_tools()).tools
            reading = {it.name for it in tools if it.annotations and it.annotations.read_only_hint}
            assert reading == set(READING)
            assert {it.name for it in tools} == set(TOOLS)
            assert all(it.description for it in tools)

    run_apart(talk())


def test_others_are_answered_while_something_takes_long(tmp_path: Path) -> None:
    """A quick question is answered first; the client hears that the long work goes on."""
    order: list[str] = []

    async def hear(seconds: float, total: float | None, message: str | None) -> None:
        order.append(message or "")

    async def talk() -> None:
        async with client_of(tmp_path) as client, anyio.create_task_group() as group:
            text = (await client.read_resource("teamformer://examples/four-robots")).contents[0]
            await ask(client, "write_mission", {"file": "a.yaml", "mission": text.text})

            async def advise() -> None:
                long = {"file": "a.yaml", "seconds": 10}
                await client.call_tool("advise", long, progress_callback=hear)
                order.append("advised")

            group.start_soon(advise)
            await anyio.sleep(0.1)
            assert await ask(client, "list_files", {}) == {"files": ["a.yaml"]}
            order.append("listed")

    run_apart(talk())
    assert order[0] == "listed"
    assert order[-1] == "advised"
    assert "at work" in order


def test_a_mistake_is_an_answer_with_a_remedy(tmp_path: Path) -> None:
    async def talk() -> None:
        async with client_of(tmp_path) as client:
            answer = await client.call_tool("run_mission", {"file": "../a.yaml"})
            assert answer.is_error
            text = getattr(answer.content[0], "text", "")
            assert text.endswith("name a file in that folder")
            assert "Traceback" not in text

    run_apart(talk())


def test_the_server_ends_with_its_client_in_the_midst_of_work(tmp_path: Path) -> None:
    server = subprocess.Popen(
        [sys.executable, *SERVER, str(tmp_path)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    assert server.stdin is not None
    assert server.stdout is not None
    about = {"protocolVersion": "2025-06-18", "capabilities": {}}
    about["clientInfo"] = {"name": "test", "version": "1"}
    mission = {"world": {"grid": [30, 30]}, "capabilities": ["a"], "robots": [], "tasks": []}
    mission["robots"] = [{"at": [x, 0], "can": ["a"]} for x in range(20)]
    mission["tasks"] = [{"at": [x, 9], "needs": ["a"]} for x in range(30)]
    (tmp_path / "m.json").write_text(json.dumps({"teamformer": 1} | mission))

    def say(**message: Any) -> None:
        assert server.stdin is not None
        server.stdin.write(json.dumps({"jsonrpc": "2.0"} | message) + "\n")
        server.stdin.flush()

    say(id=1, method="initialize", params=about)
    server.stdout.readline()
    say(method="notifications/initialized")
    long = {"name": "plan_mission", "arguments": {"file": "m.json", "seconds": 600}}
    say(id=2, method="tools/call", params=long)
    say(id=3, method="tools/call", params={"name": "list_files", "arguments": {}})
    assert json.loads(server.stdout.readline())["id"] == 3
    server.stdin.close()
    assert server.wait(timeout=60) == 0
    server.stdout.close()
