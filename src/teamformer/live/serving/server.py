"""The local server of a live mission: its page, and the socket that tells and hears.

Bound to loopback it needs no password; elsewhere the token that is printed is needed. Pages of
other sites are refused (`doors.py`), so that no web page steers a mission.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import socket
from collections.abc import AsyncIterator, Awaitable, Callable
from typing import Protocol

import uvicorn
from starlette.applications import Starlette
from starlette.middleware import Middleware
from starlette.requests import Request
from starlette.responses import HTMLResponse, PlainTextResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.websockets import WebSocket, WebSocketDisconnect

from teamformer.base.errors import TeamformerError
from teamformer.live.running.messages import LARGEST
from teamformer.live.serving.doors import Doors, KeepApart, PromptRequests
from teamformer.live.serving.downloads import DOWNLOADS, make_download
from teamformer.live.serving.errands import Conversation
from teamformer.live.serving.openapi import openapi_text
from teamformer.live.serving.watchers import Watcher
from teamformer.record.record import Record

SIGN_OF_LIFE = 5.0
"""Seconds after which a page is told that the server is there, if it is told nothing else."""

POLICY_VIOLATION = 1008  # a close code of WebSockets

Answer = Callable[[Request], Awaitable[Response]]
"""What answers a request."""


class Watched(Protocol):
    """What pages watch and speak to: a mission, the editor, or a fleet.

    `run` goes on until it is cancelled; `act` does what a page asks for, or tells it why not.
    """

    @property
    def lock(self) -> asyncio.Lock:
        """Return what has one thing at a time happen."""

    async def run(self) -> None:
        """Let time pass."""

    def join(self) -> Watcher:
        """Let a page in."""

    def leave(self, watcher: Watcher) -> None:
        """Let a page go."""

    async def act(self, watcher: Watcher, text: str) -> None:
        """Hear a page."""

    async def record(self) -> Record | None:
        """Return the record so far; None while nothing runs."""


def make_app(
    session: Watched, page: Callable[[], str], doors: Doors, on_end: Callable[[], None]
) -> Starlette:
    """Return the server's application.

    `page` makes the HTML that browsers get; `on_end` is called when the server ends, with nothing
    happening to the mission any more.
    """

    async def home(_: Request) -> Response:
        return HTMLResponse(page(), headers={"Cache-Control": "no-store"})

    async def download(request: Request) -> Response:
        return await _download(session, request.path_params["name"])

    async def description(_: Request) -> Response:
        return Response(openapi_text(), media_type="application/json")

    async def talk(connection: WebSocket) -> None:
        if doors.refusal(connection) is not None:
            await connection.close(POLICY_VIOLATION)
            return
        await connection.accept()
        watcher = session.join()
        sending = asyncio.create_task(_send(connection, watcher))
        conversation = Conversation(session.act, watcher)
        try:
            async for text in connection.iter_text():
                await conversation.hear(text)
        except (WebSocketDisconnect, KeyError):  # KeyError: bytes where text belongs
            pass
        finally:
            session.leave(watcher)
            sending.cancel()

    @contextlib.asynccontextmanager
    async def lifespan(_: Starlette) -> AsyncIterator[None]:
        clock = asyncio.create_task(session.run())
        yield
        clock.cancel()
        async with session.lock:
            on_end()

    answers = {"/": home, "/openapi.json": description, "/download/{name}": download}
    pages = [Route(path, _behind(doors, answer)) for path, answer in answers.items()]
    routes = [*pages, WebSocketRoute("/socket", talk)]
    return Starlette(routes=routes, lifespan=lifespan, middleware=[Middleware(KeepApart)])


def _behind(doors: Doors, answer: Answer) -> Answer:
    """Return what answers those who are let in, and tells the others why they are not."""

    async def answer_guest(request: Request) -> Response:
        refusal = doors.refusal(request)
        return await answer(request) if refusal is None else _plain(refusal, 403)

    return answer_guest


async def _download(session: Watched, name: str) -> Response:
    """Return a file of the mission as it is now, or why there is none."""
    if name not in DOWNLOADS:
        return _plain(f"there is no file '{name}'", 404)
    record = await session.record()
    if record is None:
        return _plain("no mission runs yet", 404)
    try:
        content = await asyncio.to_thread(make_download, record, name)
    except TeamformerError as error:
        return _plain(f"{error}; {error.hint}" if error.hint else str(error), 501)
    kept = {"Content-Disposition": f'attachment; filename="{name}"'}
    return Response(content, headers=kept, media_type="application/octet-stream")


def _plain(text: str, status: int) -> Response:
    return PlainTextResponse(f"{text}\n", status_code=status)


def configure(app: Starlette, host: str, port: int) -> uvicorn.Config:
    """Return how the application is served: quietly, with messages of bounded size."""
    return uvicorn.Config(
        app,
        host=host,
        port=port,
        http=PromptRequests,
        log_level="critical",
        ws="websockets-sansio",
        ws_max_size=LARGEST + 1000,
        timeout_graceful_shutdown=1,
    )


def serve(app: Starlette, host: str, port: int, on_start: Callable[[], None]) -> None:
    """Serve until Ctrl-C or SIGTERM; `on_start` is called once browsers may come."""

    class Server(uvicorn.Server):
        async def startup(self, sockets: list[socket.socket] | None = None) -> None:
            await super().startup(sockets)
            on_start()

    Server(configure(app, host, port)).run()


async def _send(connection: WebSocket, watcher: Watcher) -> None:
    """Send a page what it is told; one that is too far behind is let go, and may come again."""
    with contextlib.suppress(RuntimeError, WebSocketDisconnect):
        while (text := await _next_word(watcher)) is not None:
            await connection.send_text(text)
        await connection.close()


async def _next_word(watcher: Watcher) -> str | None:
    """Return what a page is told next; if it is not told anything for a while, that we are here."""
    try:
        return await asyncio.wait_for(watcher.outbox.get(), SIGN_OF_LIFE)
    except TimeoutError:
        return json.dumps({"kind": "here"})
