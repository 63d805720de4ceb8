"""Missions for Foxglove while they go on: a record that is played, or a fleet that is watched.

The topics are those of the MCAP file. Times are the mission's, from zero on.
"""

from __future__ import annotations

import threading
import time
from bisect import bisect_right

import foxglove
from foxglove.websocket import (
    Capability,
    ChannelView,
    Client,
    PlaybackCommand,
    PlaybackControlRequest,
    PlaybackState,
    PlaybackStatus,
    ServerListener,
    WebSocketServer,
)

from teamformer.base.errors import TeamformerError
from teamformer.record.export.foxglove_channels import NANOSECONDS, Channels, Told, telling
from teamformer.record.record import Record

HOST = "127.0.0.1"

TICK = 0.05
"""Seconds between two looks at the clock while a record is played."""


class Player(ServerListener):
    """Serves a record, and plays it when somebody looks: Foxglove can pause, seek and go faster.

    `run` returns when `stop` was called. Raises `TeamformerError` if the port cannot be used.
    """

    def __init__(self, record: Record, port: int) -> None:
        self._mission = record.true_mission
        self._told = list(telling(record))
        self._times = [told.time for told in self._told]
        self._lock = threading.Lock()
        self._now, self._speed = 0.0, 1.0  # nanoseconds of the mission; mission per real time
        self._is_playing, self._has_begun = True, False
        self._next = 0  # the first moment that was not told yet
        self._has_newcomer = False
        self._stopped = threading.Event()
        self._context = foxglove.Context()  # kept: nobody hears of its channels once it is gone
        self._channels = Channels(self._context)
        self._server = _start(
            record.mission.name, port, self._context, self, (0, max(self._times[-1], 1))
        )

    @property
    def url(self) -> str:
        """Return the address to open in Foxglove."""
        return f"ws://{HOST}:{self._server.port}"

    def run(self) -> None:
        """Play until told to stop; the clock starts when the first viewer subscribes."""
        before = time.monotonic()
        try:
            while not self._stopped.wait(TICK):
                now = time.monotonic()
                self._go_on((now - before) * NANOSECONDS)
                before = now
        finally:
            self._server.stop()

    def stop(self) -> None:
        """Have `run` return."""
        self._stopped.set()

    def on_subscribe(self, client: Client, channel: ChannelView) -> None:
        """Show a newcomer where everybody is, soon."""
        self._has_begun = self._has_newcomer = True

    def on_playback_control_request(self, request: PlaybackControlRequest) -> PlaybackState:
        """Do what a viewer asks for; return how it is played from now on."""
        with self._lock:
            self._is_playing = request.playback_command == PlaybackCommand.Play
            self._speed = max(request.playback_speed, 0.0)
            did_seek = request.seek_time is not None
            if request.seek_time is not None:
                self._now = float(min(max(request.seek_time, 0), self._times[-1]))
                self._next = bisect_right(self._times, self._now)
                self._has_newcomer = True  # everybody is to be shown anew
            return self._state(did_seek, request.request_id)

    def _go_on(self, nanoseconds: float) -> None:
        """Tell what has become due."""
        with self._lock:
            was_over = self._is_over
            if self._has_begun and self._is_playing:
                self._now = min(self._now + nanoseconds * self._speed, self._times[-1])
            if self._has_newcomer:
                self._has_newcomer = False
                self._channels.map(self._mission, round(self._now))
                if self._next > 0:
                    self._channels.show(self._mission, self._told[self._next - 1])
            due = bisect_right(self._times, self._now) if self._has_begun else 0
            for told in self._told[self._next : due]:
                self._channels.tell(self._mission, told)
            self._next = max(self._next, due)
            if self._is_over != was_over:
                self._server.broadcast_playback_state(self._state(False, None))

    @property
    def _is_over(self) -> bool:
        return self._next == len(self._told)

    def _state(self, did_seek: bool, request: str | None) -> PlaybackState:
        status = PlaybackStatus.Playing if self._is_playing else PlaybackStatus.Paused
        if self._is_over:
            status = PlaybackStatus.Ended
        return PlaybackState(status, round(self._now), self._speed, did_seek, request)


class Follower(ServerListener):
    """Serves a record that grows; raises `TeamformerError` if the port cannot be used."""

    def __init__(self, name: str, port: int) -> None:
        self._context = foxglove.Context()  # kept: nobody hears of its channels once it is gone
        self._channels = Channels(self._context)
        self._count = 0  # moments that were told
        self._has_ended = False
        self._has_newcomer = True
        self._server = _start(name, port, self._context, self, None)

    @property
    def url(self) -> str:
        """Return the address to open in Foxglove."""
        return f"ws://{HOST}:{self._server.port}"

    def follow(self, record: Record) -> None:
        """Tell what is new in a record since it was last given; newcomers get the map."""
        told = list(telling(record))
        if self._has_newcomer:
            self._has_newcomer = False
            self._channels.map(record.true_mission, told[-1].time)
        for each in told[self._count :]:
            self._channels.tell(record.true_mission, self._without_ending(each, record))
        self._count = len(told)

    def close(self) -> None:
        """Serve no more."""
        self._server.stop()

    def on_subscribe(self, client: Client, channel: ChannelView) -> None:
        """Show a newcomer the map with the next step, which has all else."""
        self._has_newcomer = True

    def _without_ending(self, told: Told, record: Record) -> Told:
        """Return it without how the record ends, unless that is news: all is done."""
        status = record.end.status
        is_news = status == "completed" and not self._has_ended
        if told.moment.step < len(record.steps):
            return told
        self._has_ended = self._has_ended or is_news
        return told._replace(
            events=[event for event in told.events if is_news or event.kind != status]
        )


def _start(
    name: str,
    port: int,
    context: foxglove.Context,
    listener: ServerListener,
    span: tuple[int, int] | None,
) -> WebSocketServer:
    capabilities = [] if span is None else [Capability.PlaybackControl]
    try:
        return foxglove.start_server(
            name=name,
            host=HOST,
            port=port,
            capabilities=capabilities,
            server_listener=listener,
            context=context,
            playback_time_range=span,
        )
    except (OSError, RuntimeError) as error:
        raise TeamformerError(
            f"Foxglove cannot be served on {HOST}:{port}: {error}", "name another port"
        ) from None
