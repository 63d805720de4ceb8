"""`teamformer fleet watch`: a running fleet in the browser."""

from __future__ import annotations

import contextlib
from pathlib import Path
from typing import TYPE_CHECKING

from teamformer.commands.console import prepare_folder, say
from teamformer.commands.missions.live import Address, check_address, serve_page
from teamformer.commands.robots.mesh import FleetAt, dial_as_operator, read_fleet_mission
from teamformer.extras import require

if TYPE_CHECKING:
    from teamformer.fleet.observer.session import ObserverSession


def watch(path: Path, fleet: FleetAt, address: Address, folder: Path) -> int:
    """Serve the page of a running fleet until Ctrl-C; return the exit status.

    What was seen by then is saved.
    """
    require("live", "starlette", "uvicorn", "websockets")
    prepare_folder(folder)
    check_address(address)
    with contextlib.closing(_observe(path, fleet, folder)) as onlooker:
        serve_page(onlooker, "fleet", address)
    return 0


def _observe(path: Path, fleet: FleetAt, folder: Path) -> ObserverSession:
    """Return the session of a running fleet."""
    mission = read_fleet_mission(path, "zenoh")
    from teamformer.fleet.observer.session import ObserverSession
    from teamformer.fleet.observer.watch import Watch

    transport, post = dial_as_operator(mission, fleet)
    return ObserverSession(Watch(mission), transport, post, folder, say)
