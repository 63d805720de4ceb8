"""A client of Foxglove's WebSocket protocol, by the websockets and protobuf libraries alone."""

from __future__ import annotations

import base64
import json
import struct
import time
from collections.abc import Iterator
from contextlib import ExitStack
from typing import Any, NamedTuple

from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from websockets.sync.client import connect

MESSAGE_DATA = 1
PLAYBACK_STATE = 5


class Heard(NamedTuple):
    topic: str
    time: int  # nanoseconds
    message: Any


class FoxgloveClient:
    """Subscribes to every topic that a server advertises, and decodes by the schemas it sends."""

    def __init__(self, url: str) -> None:
        self._open = ExitStack()
        connection = connect(url, subprotocols=["foxglove.sdk.v1"])  # type: ignore[list-item]
        self._socket = self._open.enter_context(connection)
        self.info: dict[str, Any] = {}
        self.schemas: dict[str, str] = {}
        self._kinds: dict[int, tuple[str, Any]] = {}

    def __enter__(self) -> FoxgloveClient:
        return self

    def __exit__(self, *_: object) -> None:
        self._open.close()

    def messages(self, seconds: float = 20.0) -> Iterator[Heard]:
        """Yield what is heard; raise TimeoutError when that took too long."""
        deadline = time.monotonic() + seconds
        while True:
            data = self._socket.recv(timeout=max(deadline - time.monotonic(), 0.0))
            if isinstance(data, str):
                self._take(json.loads(data))
            elif data[0] == MESSAGE_DATA:
                number, stamp = struct.unpack_from("<IQ", data, 1)
                topic, kind = self._kinds[number]
                yield Heard(topic, stamp, kind.FromString(data[13:]))

    def control(self, command: int, speed: float, seek: int | None = None) -> None:
        """Ask a server that plays a record to play (0) or to pause (1), here or elsewhere."""
        name = b"request"
        has_seek, where = seek is not None, seek or 0
        told = struct.pack("<BBfBQI", 3, command, speed, has_seek, where, len(name))
        self._socket.send(told + name)

    def _take(self, news: dict[str, Any]) -> None:
        if news["op"] == "serverInfo":
            self.info = news
        elif news["op"] == "advertise":
            for channel in news["channels"]:
                self.schemas[channel["topic"]] = channel["schemaName"]
                self._kinds[channel["id"]] = (channel["topic"], _kind(channel))
            wanted = [{"id": c["id"], "channelId": c["id"]} for c in news["channels"]]
            self._socket.send(json.dumps({"op": "subscribe", "subscriptions": wanted}))


def _kind(channel: dict[str, Any]) -> Any:
    files = descriptor_pb2.FileDescriptorSet.FromString(base64.b64decode(channel["schema"]))
    pool = descriptor_pool.DescriptorPool()
    for file in files.file:
        pool.Add(file)
    return message_factory.GetMessageClass(pool.FindMessageTypeByName(channel["schemaName"]))
