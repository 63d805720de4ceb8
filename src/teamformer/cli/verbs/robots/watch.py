"""`teamformer fleet watch`: a running fleet in the browser."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from teamformer.base.extras import require
from teamformer.cli.terminal.addresses import HostAndPort, check_address
from teamformer.cli.terminal.console import prepare_folder, say
from teamformer.cli.terminal.foxglove import check_foxglove, follow_in_foxglove
from teamformer.cli.verbs.missions.live import sending_alerts, serve_page
from teamformer.cli.verbs.robots.mesh import FleetAt, dial_as_operator, read_fleet_mission

if TYPE_CHECKING:
    from teamformer.fleet.fleet_mission import FleetMission
    from teamformer.fleet.observer.session import ObserverSession
    from teamformer.live.running.alarm import OnAlerts


@dataclass(frozen=True)
class WatchOptions:
    """What the command line says of watching a fleet.

    `foxglove` is a port on which Foxglove may watch too, `webhook` an address to send alerts to.
    """

    address: HostAndPort
    folder: Path
    foxglove: int | None = None
    webhook: str = ""


def watch(path: Path, fleet: FleetAt, options: WatchOptions) -> int:
    """Serve the page of a running fleet until Ctrl-C; return the exit status.

    What was seen by then is saved.
    """
    require("live")
    prepare_folder(options.folder)
    check_address(options.address)
    if options.foxglove is not None:
        check_foxglove(options.foxglove)
    mission = read_fleet_mission(path, "zenoh")
    with contextlib.ExitStack() as stack:
        tell = stack.enter_context(sending_alerts(options.webhook, mission.source.name))
        onlooker = stack.enter_context(
            contextlib.closing(_observe(mission, fleet, options.folder, tell))
        )
        if options.foxglove is not None:
            follower = stack.enter_context(
                contextlib.closing(follow_in_foxglove(mission.source.name, options.foxglove))
            )
            onlooker.on_step = follower.follow
        serve_page(onlooker, "fleet", options.address)
    return 0


def _observe(
    mission: FleetMission, fleet: FleetAt, folder: Path, on_alerts: OnAlerts
) -> ObserverSession:
    """Return the session of a running fleet."""
    from teamformer.fleet.observer.session import ObserverSession
    from teamformer.fleet.observer.watch import Watch
    from teamformer.fleet.observer.watch_in_time import WatchInTime

    transport, post = dial_as_operator(mission, fleet)
    watch = Watch(mission) if mission.source.time == "steps" else WatchInTime(mission)
    return ObserverSession(watch, transport, post, folder, say, on_alerts)
