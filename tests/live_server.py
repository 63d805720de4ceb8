"""A live mission on a free port, served from a thread: for the tests of server and page."""

from __future__ import annotations

import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from teamformer.cli.terminal.addresses import HostAndPort
from teamformer.files.mission_files import mission_from_tree
from teamformer.live.session import Session
from teamformer.live.steps.mission_with_past import RunningMission
from teamformer.live.workshop import Workshop
from teamformer.methods.by_name import load_method
from teamformer.mission.model import Mission
from teamformer.viewer.html import live_page

HERE = HostAndPort()


@dataclass
class Served:
    """A server that runs, and its mission."""

    port: int
    session: Any

    @property
    def address(self) -> str:
        return f"127.0.0.1:{self.port}"


def small_mission() -> Mission:
    """Three robots at the left, three tasks at the right, a wall between; 13 steps."""
    return mission_from_tree(
        {
            "teamformer": 1,
            "name": "small",
            "world": {"rows": ["............", ".....@@.....", ".....@@.....", "............"]},
            "capabilities": ["lift", "scan"],
            "robots": [
                {"name": "r1", "at": [0, 0], "can": ["lift"]},
                {"name": "r2", "at": [0, 3], "can": ["scan"]},
                {"name": "r3", "at": [1, 3], "can": ["lift", "scan"]},
            ],
            "tasks": [
                {"name": "a", "at": [10, 0], "needs": ["lift", "scan"]},
                {"name": "b", "at": [10, 3], "needs": ["scan"], "duration": 3},
                {"name": "c", "at": [7, 2], "needs": ["lift"]},
            ],
        }
    )


@contextmanager
def serving(
    source: Mission,
    folder: Path,
    speed: float = 20.0,
    token: str | None = None,
    method: str = "join-fitting",
    address: HostAndPort = HERE,
) -> Iterator[Served]:
    """Serve a mission that runs by a method while the block runs.

    `address` is where the page is to be asked for; it is served here on a free port.
    """
    mission = RunningMission(source, lambda: load_method(method), 0)
    with serving_session(Session(mission, folder, speed), token, address=address) as served:
        yield served


@contextmanager
def serving_editor(folder: Path, speed: float = 20.0) -> Iterator[Served]:
    """Serve the editor, whose missions run by the method `join-fitting`."""

    def start(mission: Mission) -> RunningMission:
        return RunningMission(mission, lambda: load_method("join-fitting"), 0)

    with serving_session(Workshop(start, folder, speed)) as served:
        yield served


@contextmanager
def serving_session(
    session: Session | Workshop,
    token: str | None = None,
    port: int = 0,
    address: HostAndPort = HERE,
) -> Iterator[Served]:
    """Serve what pages speak to while the block runs, at a port that is free if none is given."""
    import uvicorn

    from teamformer.live.serving.doors import Doors
    from teamformer.live.serving.server import configure, make_app

    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        probe.bind(("127.0.0.1", port))
        port = int(probe.getsockname()[1])
    doors = Doors(address.names, token, frozenset(address.further))
    app = make_app(session, lambda: live_page("test"), doors, session.save)
    server = uvicorn.Server(configure(app, "127.0.0.1", port))
    thread = threading.Thread(target=server.run)
    thread.start()
    try:
        while not server.started:
            time.sleep(0.01)
        yield Served(port, session)
    finally:
        server.should_exit = True
        thread.join()
