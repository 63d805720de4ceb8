"""What Foxglove hears of a mission that is played and of one that grows, read back by a client."""

from __future__ import annotations

import json
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import closing, contextmanager
from dataclasses import replace
from pathlib import Path

import pytest

pytest.importorskip("foxglove")
pytest.importorskip("google.protobuf")

from foxglove_client import FoxgloveClient, Heard
from teamformer.base.errors import TeamformerError
from teamformer.fleet.process.fleet import free_ports
from teamformer.record.export.foxglove_server import Follower, Player
from teamformer.record.record import Record
from test_export import two_lifters

ROOT = Path(__file__).parents[2]
SECOND = 1_000_000_000


@contextmanager
def playing(record: Record) -> Iterator[str]:
    player = Player(record, free_ports(1)[0])
    thread = threading.Thread(target=player.run)
    thread.start()
    try:
        yield player.url
    finally:
        player.stop()
        thread.join()


def until_log(client: FoxgloveClient, last: str, seconds: float = 20.0) -> list[Heard]:
    heard: list[Heard] = []
    for one in client.messages(seconds):
        heard.append(one)
        if one.topic == "/log" and one.message.message == last:
            return heard
    raise AssertionError


def places(heard: Heard) -> dict[str, tuple[float, float]]:
    return {
        each.child_frame_id.removeprefix("robot/"): (each.translation.x, each.translation.y)
        for each in heard.message.transforms
    }


def test_a_record_is_played_from_the_start_when_somebody_looks() -> None:
    """The six steps take a second each; the client asks for a hundred times that speed."""
    record = two_lifters()
    with playing(record) as url, FoxgloveClient(url) as client:
        next(client.messages())
        client.control(0, 100.0)
        heard = until_log(client, record.end.status)
    assert client.schemas == {
        "/tf": "foxglove.FrameTransforms",
        "/mission": "foxglove.SceneUpdate",
        "/map": "foxglove.Grid",
        "/log": "foxglove.Log",
    }
    assert "playbackControl" in client.info["capabilities"]
    frames = [one for one in heard if one.topic == "/tf"]
    steps = sorted({one.time for one in frames})
    assert steps[-1] == len(record.steps) * SECOND
    assert set(steps) <= {step * SECOND for step in range(len(record.steps) + 1)}
    assert set(places(frames[0])) == {robot.name for robot in record.mission.robots}
    assert "=b" not in places(frames[-1])  # lost
    told = [one.message.message for one in heard if one.topic == "/log"]
    assert told.count(record.end.status) == 1
    assert any(text.endswith("=b lost") for text in told)


def test_a_viewer_can_go_back() -> None:
    record = two_lifters()
    with playing(record) as url, FoxgloveClient(url) as client:
        next(client.messages())
        client.control(0, 1000.0)
        until_log(client, record.end.status)
        client.control(1, 1.0, 2 * SECOND)  # pauses in step 2
        again = next(one for one in client.messages() if one.topic == "/tf")
    assert again.time == 2 * SECOND
    start = {robot.name for robot in record.mission.robots}
    assert set(places(again)) == start


def test_what_grows_is_told_step_by_step() -> None:
    """The record goes on by a step each time, until the client has heard of a loss in it."""
    whole = two_lifters()
    running = replace(whole.end, status="interrupted", makespan=None)
    is_heard = threading.Event()

    def grow(follower: Follower) -> None:
        for count in range(1, len(whole.steps) + 1):
            follower.follow(replace(whole, steps=whole.steps[:count], end=running))
            is_heard.wait(0.3)

    with (
        closing(Follower("beam", free_ports(1)[0])) as follower,
        FoxgloveClient(follower.url) as client,
    ):
        thread = threading.Thread(target=grow, args=(follower,))
        thread.start()
        heard = until_log(client, "=b lost")
        is_heard.set()
        thread.join()
    frames = [one.time for one in heard if one.topic == "/tf"]
    assert frames == sorted(set(frames))  # each step once, in order
    assert len(frames) >= 2
    assert {one.topic for one in heard} >= {"/tf", "/mission", "/map"}
    told = [one.message.message for one in heard if one.topic == "/log"]
    assert "interrupted" not in told


def test_a_port_in_use_is_told() -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        with pytest.raises(TeamformerError, match=f"cannot be served on 127.0.0.1:{port}"):
            Follower("x", port)
        words = ["run", "examples/four-robots.yaml", "--foxglove", str(port)]
        ended = teamformer(words)
    assert ended.returncode == 2
    assert f"error: 127.0.0.1:{port} cannot be used" in ended.stderr
    assert "hint: try --foxglove " in ended.stderr
    assert ended.stdout == ""  # nothing was run


def test_a_rehearsal_is_served_one_schedule_at_a_time() -> None:
    words = ["fleet", "rehearse", "examples/four-robots.yaml", "--foxglove", str(free_ports(1)[0])]
    ended = teamformer(words)
    assert ended.returncode == 2
    assert "--foxglove is for one schedule" in ended.stderr


def teamformer(words: list[str]) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "teamformer.cli", *words]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True)


@pytest.mark.parametrize("verb", ["run", "fleet rehearse --schedule 1"])
@pytest.mark.thorough
def test_the_command_line_serves_until_ctrl_c(verb: str) -> None:
    port = free_ports(1)[0]
    words = [*verb.split(), "examples/four-robots.yaml", "--foxglove", str(port), "--json"]
    command = [sys.executable, "-m", "teamformer.cli", *words]
    with subprocess.Popen(command, cwd=ROOT, stdout=-1, stderr=-1, text=True) as process:
        assert process.stderr is not None
        for line in process.stderr:
            if line.startswith("Foxglove: "):
                break
        try:
            with FoxgloveClient(f"ws://127.0.0.1:{port}") as client:
                frame = next(one for one in client.messages() if one.topic == "/tf")
        finally:
            process.send_signal(signal.SIGINT)
            out, _ = process.communicate(timeout=60)
    assert frame.time == 0
    assert set(places(frame)) == {"r1", "r2", "r3", "r4"}
    assert process.returncode == 0
    assert json.loads(out)


@pytest.mark.slow
def test_a_running_fleet_is_followed(tmp_path: Path) -> None:
    """Four processes do four tasks; the client hears of each from the process that watches."""
    port, page = free_ports(2)
    command = [sys.executable, "-m", "teamformer.cli", "fleet"]
    mission = "examples/four-robots.yaml"
    start = [*command, "start", mission, "--json", "--time-limit", "120"]
    with subprocess.Popen(start, cwd=ROOT, stdout=-1, stderr=-1, text=True) as fleet:
        assert fleet.stderr is not None
        endpoint = next(line.split()[-1] for line in fleet.stderr if line.startswith("world at"))
        watch = [*command, "watch", mission, "--connect", endpoint, "--port", str(page)]
        watch += ["--foxglove", str(port), "--out", str(tmp_path)]
        with subprocess.Popen(watch, cwd=ROOT, stdout=-1, stderr=-1, text=True) as watcher:
            assert watcher.stderr is not None
            try:
                next(line for line in watcher.stderr if line.startswith("Foxglove: "))
                with FoxgloveClient(f"ws://127.0.0.1:{port}") as client:
                    heard = until_log(client, "completed", 100.0)
            finally:
                watcher.send_signal(signal.SIGINT)
                watcher.communicate(timeout=60)
        fleet.communicate(timeout=60)
    told = [one.message.message for one in heard if one.topic == "/log"]
    assert {text.split()[0] for text in told if " done by " in text} == {"t1", "t2", "t3", "t4"}
    frames = [one for one in heard if one.topic == "/tf"]
    assert set(places(frames[-1])) == {"r1", "r2", "r3", "r4"}
