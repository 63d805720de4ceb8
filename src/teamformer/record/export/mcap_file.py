"""A record as an MCAP file that Foxglove opens."""

from __future__ import annotations

from pathlib import Path

import foxglove

from teamformer.record.export.foxglove_channels import Channels, telling
from teamformer.record.record import Record


def write_mcap(record: Record, path: Path) -> None:
    """Write a record as MCAP, over what is there."""
    context = foxglove.Context()
    channels = Channels(context)
    with foxglove.open_mcap(path, allow_overwrite=True, context=context):
        channels.map(record.mission)
        for told in telling(record):
            channels.tell(record.true_mission, told)
