"""`--foxglove PORT`: a mission, a rehearsal or a fleet for Foxglove, on this machine."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING

from teamformer.base.extras import require
from teamformer.cli.terminal.addresses import HostAndPort, check_address
from teamformer.cli.terminal.console import say
from teamformer.record.record import Record

if TYPE_CHECKING:
    from teamformer.record.export.foxglove_server import Follower


def check_foxglove(port: int) -> None:
    """Raise `TeamformerError` if the library is missing or the port is not free."""
    require("mcap", "foxglove")
    check_address(HostAndPort("127.0.0.1", port), "--foxglove")


def play_in_foxglove(record: Record, port: int) -> None:
    """Serve a record, and play it when somebody looks, until Ctrl-C."""
    from teamformer.record.export.foxglove_server import Player

    player = Player(record, port)
    say(f"Foxglove: open a connection to {player.url}; Ctrl-C ends it")
    with suppress(KeyboardInterrupt):
        player.run()


def follow_in_foxglove(name: str, port: int) -> Follower:
    """Return what serves a record that grows."""
    from teamformer.record.export.foxglove_server import Follower

    follower = Follower(name, port)
    say(f"Foxglove: open a connection to {follower.url}")
    return follower
