"""Alerts of live missions and fleets, sent to a real server of the web on this machine."""

from __future__ import annotations

import json
import queue
import threading
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path
from typing import Any

import pytest

from live_server import serving_session, small_mission
from small_worlds import make, robot, task
from teamformer.base.errors import TeamformerError
from teamformer.live.running.alarm import Alarm, troubles_of
from teamformer.live.running.alerts import Alert
from teamformer.live.running.incidents import LostRobot, RobotBack
from teamformer.live.serving.webhook import Webhook
from teamformer.live.session import Session
from teamformer.live.steps.mission_with_past import RunningMission
from teamformer.methods.by_name import load_method
from teamformer.mission.model import Mission

LOST = Alert("robot 1", "bolt is lost", "since step 4", "others do its tasks", since=0.0)


@dataclass
class Receiver:
    """A server that answers each POST with the next of `answers`, then 204, and keeps them."""

    url: str
    answers: list[int]
    came: queue.Queue[tuple[dict[str, str], dict[str, Any]]] = field(default_factory=queue.Queue)

    def next(self) -> dict[str, Any]:
        return self.came.get(timeout=20)[1]


@pytest.fixture
def receiver() -> Iterator[Receiver]:
    class Handler(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            body = self.rfile.read(int(self.headers["Content-Length"]))
            kept.came.put((dict(self.headers), json.loads(body)))
            self.send_response(kept.answers.pop(0) if kept.answers else 204)
            self.end_headers()

        def log_message(self, format: str, *args: Any) -> None:
            pass

    server = HTTPServer(("127.0.0.1", 0), Handler)
    kept = Receiver(f"http://127.0.0.1:{server.server_port}/hook?key=secret", [])
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    yield kept
    server.shutdown()
    thread.join()
    server.server_close()


def running(mission: Mission) -> RunningMission:
    return RunningMission(mission, lambda: load_method("join-all"), 0)


def test_an_alert_is_posted_as_it_begins_and_as_it_ends(receiver: Receiver) -> None:
    hook = Webhook(receiver.url, "night shift")
    hook.tell([LOST], [])
    hook.tell([Alert("back 1", "bolt is back", "", "", since=0.0)], [LOST])
    headers, raised = receiver.came.get(timeout=20)
    ended = receiver.next()
    hook.close()
    assert headers["Content-Type"] == "application/json"
    assert raised["event"] == "raised"
    assert raised["text"] == "night shift: bolt is lost: since step 4; others do its tasks"
    assert raised["alert"] == {key: getattr(LOST, key) for key in ("key", "what", "why", "do")}
    assert raised["at"].endswith("+00:00")
    assert (ended["event"], ended["text"]) == ("ended", "night shift: no longer: bolt is lost")
    assert receiver.came.empty()  # that it is back is the end of the alert


def test_what_is_not_taken_is_sent_again_in_its_order(receiver: Receiver) -> None:
    receiver.answers[:] = [500, 503]
    said: list[str] = []
    hook = Webhook(receiver.url, "m", said.append, pauses=(0.0, 0.0, 0.0))
    hook.tell([LOST], [])
    hook.tell([], [LOST])
    assert [receiver.next()["event"] for _ in range(4)] == ["raised"] * 3 + ["ended"]
    hook.close()
    assert said == []


def test_an_address_that_takes_nothing_is_complained_of_once(receiver: Receiver) -> None:
    receiver.answers[:] = [404] * 4
    said: list[str] = []
    hook = Webhook(receiver.url, "m", said.append, pauses=(0.0,))
    hook.tell([LOST], [LOST])
    assert {receiver.next()["event"] for _ in range(4)} == {"raised", "ended"}
    hook.close()
    assert said == ["alerts are not taken by 127.0.0.1: it answers 404 Not Found"]


def test_nobody_there_is_no_reason_to_wait() -> None:
    said: list[str] = []
    hook = Webhook("http://127.0.0.1:9/", "m", said.append, pauses=())
    hook.tell([LOST], [])
    hook.close()
    assert said == ["alerts are not taken by 127.0.0.1: [Errno 111] Connection refused"]


@pytest.mark.parametrize("url", ["file:///etc/passwd", "chat.example.org", "http://", "http://[::"])
def test_only_addresses_of_the_web_are_taken(url: str) -> None:
    with pytest.raises(TeamformerError, match="no address of the web"):
        Webhook(url, "m")


def test_a_live_mission_has_alerts_of_robots_and_tasks() -> None:
    """r1 is lost before it does t1, due at step 3, and comes back while r2 walks there."""
    mission = make([robot("a", 0), robot("b", 9), robot("b", 0)], [task("a", 19), task("b", 8)])
    tasks = (mission.tasks[0], replace(mission.tasks[1], between=(0, 3)))
    live = running(replace(mission, tasks=tasks))
    told: list[tuple[int, list[str], list[str]]] = []

    def tell(new: Sequence[Alert], past: Sequence[Alert]) -> None:
        told.append((live.steps, [it.what for it in new], [it.what for it in past]))

    alarm = Alarm(["r0", "r1", "r2"], tell)
    live.happen(LostRobot("r1"))
    while live.is_running:
        if live.steps == 5:
            live.happen(RobotBack("r1"))
        live.step()
        alarm.look(live)
    assert told[:3] == [
        (1, ["r1 is lost"], []),
        (4, ["t1 is late"], []),
        (6, ["r1 is back"], ["r1 is lost", "t1 is late"]),  # it is done in the same step
    ]
    assert list(troubles_of(live)) == []


def test_a_mission_that_cannot_end_is_an_alert() -> None:
    mission = make([robot("a", 0), robot("b", 9)], [task("a", 1), task("b", 2)])
    live = running(mission)
    live.happen(LostRobot("r1"))
    while live.is_running:
        live.step()
    lost, end = troubles_of(live)
    assert lost.what == "r1 is lost"
    assert end.text() == (
        f"not done: t1: it ended at step {live.steps}: infeasible; bring lost robots back, or undo"
    )


def test_a_session_tells_its_alerts(tmp_path: Path, receiver: Receiver) -> None:
    """As a page has a robot lost and back, the webhook hears of it."""
    client = pytest.importorskip("websockets.sync.client")
    hook = Webhook(receiver.url, "small")
    session = Session(running(small_mission()), tmp_path, 20.0, on_alerts=hook.tell)
    with serving_session(session) as served:
        origin = f"http://{served.address}"
        with client.connect(f"ws://{served.address}/socket", origin=origin) as page:
            for message in ({"do": "happen", "lost": "r1"}, {"do": "step"}):
                page.send(json.dumps(message))
            assert receiver.next()["alert"]["what"] == "r1 is lost"
            page.send(json.dumps({"do": "undo"}))
            assert receiver.next()["text"] == "small: no longer: r1 is lost"
    hook.close()
