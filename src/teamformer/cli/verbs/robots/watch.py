"""`teamformer fleet watch`: a running fleet in the browser."""

from __future__ import annotations

import contextlib
from pathlib import Path
from typing import TYPE_CHECKING

from teamformer.base.extras import require
from teamformer.cli.terminal.addresses import HostAndPort, check_address
from teamformer.cli.terminal.console import prepare_folder, say
from teamformer.cli.terminal.foxglove import check_foxglove, follow_in_foxglove
from teamformer.cli.verbs.missions.live import serve_page
from teamformer.cli.verbs.robots.mesh import FleetAt, dial_as_operator, read_fleet_mission

if TYPE_CHECKING:
    from teamformer.fleet.observer.session import ObserverSession


def watch(
    path: Path, fleet: FleetAt, address: HostAndPort, folder: Path, foxglove: int | None = None
) -> int:
    """Serve the page of a running fleet until Ctrl-C; return the exit status.

    What was seen by then is saved. `foxglove` is a port on which Foxglove may watch too.
    """
    require("live")
    prepare_folder(folder)
    check_address(address)
    if foxglove is not None:
        check_foxglove(foxglove)
    with contextlib.ExitStack() as stack:
        onlooker = stack.enter_context(contextlib.closing(_observe(path, fleet, folder)))
        if foxglove is not None:
            follower = stack.enter_context(
                contextlib.closing(follow_in_foxglove(onlooker.watch.source.name, foxglove))
            )
            onlooker.on_step = follower.follow
        serve_page(onlooker, "fleet", address)
    return 0


def _observe(path: Path, fleet: FleetAt, folder: Path) -> ObserverSession:
    """Return the session of a running fleet."""
    mission = read_fleet_mission(path, "zenoh")
    from teamformer.fleet.observer.session import ObserverSession
    from teamformer.fleet.observer.watch import Watch

    transport, post = dial_as_operator(mission, fleet)
    return ObserverSession(Watch(mission), transport, post, folder, say)
