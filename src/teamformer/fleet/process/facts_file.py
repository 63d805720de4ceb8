"""What a robot must not forget, in a file that is whole at any moment."""

from __future__ import annotations

import os
import time
from pathlib import Path

from msgspec import DecodeError, Struct, ValidationError
from msgspec.msgpack import decode, encode
from msgspec.structs import replace

from teamformer.base.errors import TeamformerError
from teamformer.fleet.agent.knowledge import Remembered
from teamformer.fleet.messages import PROTOCOL


class Saved(Struct, array_like=True):
    """The content of the file."""

    protocol: int
    mission: int
    robot: int
    remembered: Remembered


class FactsFile:
    """One robot's facts; written beside itself first, so that a crash leaves the old or the new."""

    def __init__(self, path: Path, mission: int, robot: int) -> None:
        self._path = path
        self._mission, self._robot = mission, robot

    def read(self) -> Remembered | None:
        """Return what was remembered; None if there is no file yet."""
        try:
            data = self._path.read_bytes()
        except FileNotFoundError:
            return None
        except OSError as error:
            reason = f"{self._path}: cannot be read: {error.strerror}"
            raise TeamformerError(reason, "name a file; it is written if there is none") from None
        try:
            saved = decode(data, type=Saved)
        except (ValidationError, DecodeError):
            hint = "move it away; the robot then learns from the others what was done"
            raise TeamformerError(f"{self._path}: this is no facts file", hint) from None
        if saved.protocol > PROTOCOL:
            raise TeamformerError(
                f"{self._path}: format {saved.protocol} is newer than {PROTOCOL}",
                "install a newer teamformer",
            )
        if (saved.mission, saved.robot) != (self._mission, self._robot):
            hint = "name another file with --facts"
            raise TeamformerError(f"{self._path}: this is of another mission or robot", hint)
        return saved.remembered.read_at(time.time())

    def write(self, remembered: Remembered) -> None:
        """Replace the file; when this returns, it is on the disk."""
        kept = replace(remembered, seen_at=time.time())
        part = self._path.with_name(self._path.name + ".part")
        with part.open("wb") as file:
            file.write(encode(Saved(PROTOCOL, self._mission, self._robot, kept)))
            file.flush()
            os.fsync(file.fileno())
        os.replace(part, self._path)
