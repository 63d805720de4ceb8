"""The server of the Model Context Protocol: tools beside the conversation, and resources."""

from __future__ import annotations

import inspect
import time
from collections.abc import Awaitable, Callable
from functools import partial
from importlib.metadata import version
from typing import Any

import anyio
import anyio.to_thread
from mcp.server.mcpserver import Context, MCPServer
from mcp.server.mcpserver.exceptions import ToolError
from mcp.types import ToolAnnotations

from teamformer.base.errors import TeamformerError
from teamformer.trials.mcp import resources
from teamformer.trials.mcp.telling import Told, in_words
from teamformer.trials.mcp.workbench import READING, TOOLS, Workbench

SIGN_OF_LIFE = 2.0
"""Seconds between signs that a tool is still at work, for clients that wait only so long."""

INSTRUCTIONS = """\
Teams of robots with different capabilities share out tasks, some of which need several robots at \
once. Draw up a mission with write_mission (read teamformer://mission-file and an example first), \
run it with run_mission, ask explain why it took so long, and advise what would help. All files \
are in one folder; names are as seen from there. Results are short; records and pages are in files.
"""


def make_server(bench: Workbench) -> MCPServer[Any]:
    """Return the server of the tools of a workbench, with the resources."""
    server: MCPServer[Any] = MCPServer(
        "teamformer", instructions=INSTRUCTIONS, version=version("teamformer"), log_level="WARNING"
    )
    for name in TOOLS:
        tool = getattr(bench, name)
        about = " ".join(tool.__doc__.split())
        hints = ToolAnnotations(read_only_hint=name in READING, open_world_hint=False)
        call = _beside(tool, f"{bench.folder.root}/")
        server.add_tool(call, name=name, description=about, annotations=hints)
    _add_resources(server)
    return server


def _beside(tool: Callable[..., Told], root: str) -> Callable[..., Awaitable[Told]]:
    """Return a tool that works in a thread, so that the conversation goes on meanwhile.

    What it is asked for in vain is told without `root`, as a client names files.
    """

    async def call(context: Context[Any, Any], **arguments: Any) -> Told:
        async with anyio.create_task_group() as group:
            group.start_soon(_say_that_it_goes_on, context)
            answer = await anyio.to_thread.run_sync(
                partial(_answer, tool, arguments), abandon_on_cancel=True
            )
            group.cancel_scope.cancel()
        if isinstance(answer, str):
            raise ToolError(answer.replace(root, ""))
        return answer

    asked = inspect.signature(tool, eval_str=True)
    context = inspect.Parameter("context", inspect.Parameter.KEYWORD_ONLY, annotation=Context)
    shown = asked.replace(parameters=[*asked.parameters.values(), context])
    call.__signature__ = shown  # type: ignore[attr-defined]
    kinds = {name: one.annotation for name, one in shown.parameters.items()}
    call.__annotations__ = kinds | {"return": shown.return_annotation}
    return call


def _answer(tool: Callable[..., Told], arguments: dict[str, Any]) -> Told | str:
    """Return a tool's result, or in words what is wrong with what it was asked for."""
    try:
        return tool(**arguments)
    except TeamformerError as error:
        return in_words(error)
    except OSError as error:  # a disk that is full, say
        return f"{error.filename or 'a file'}: {error.strerror or error}"


async def _say_that_it_goes_on(context: Context[Any, Any]) -> None:
    """Tell a client that waits for a result how many seconds it has waited, if it wants to know."""
    begun = time.monotonic()
    while True:
        await anyio.sleep(SIGN_OF_LIFE)
        await context.report_progress(round(time.monotonic() - begun, 1), message="at work")


def _add_resources(server: MCPServer[Any]) -> None:
    add = server.resource
    add("teamformer://schema", mime_type="application/schema+json")(resources.schema)
    add("teamformer://mission-file", mime_type="text/markdown")(resources.mission_pages)
    add("teamformer://methods", mime_type="text/plain")(resources.methods)
    for name in resources.example_names():
        uri = f"teamformer://examples/{name}"
        add(uri, name=name, mime_type="application/yaml")(_reader_of(name))


def _reader_of(name: str) -> Callable[[], str]:
    """Return what reads an example; a resource of its own has no arguments."""

    def read() -> str:
        return resources.example(name)

    return read
