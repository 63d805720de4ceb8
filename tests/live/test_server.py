"""The server of a live mission, spoken to as a page does, and as one that means harm."""

from __future__ import annotations

import http.client
import io
import json
import re
import socket
import threading
import time
import zipfile
from collections.abc import Iterator
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from live_server import Served, serving, serving_editor, serving_session, small_mission
from teamformer.base.errors import TeamformerError
from teamformer.cli.terminal import addresses
from teamformer.cli.terminal.addresses import HostAndPort, address_of
from teamformer.files.mission_files import mission_to_tree
from teamformer.live.drawing.drafts import Draft
from teamformer.live.running.incidents import Incident
from teamformer.live.running.what_if import IsOver, WhatIf, what_if
from teamformer.live.steps.mission_with_past import RunningMission
from teamformer.live.workshop import Workshop
from teamformer.methods.by_name import load_method
from teamformer.mission.model import Mission
from teamformer.planning.bounds.makespan import lower_bound
from teamformer.record.export.csv_tables import write_tables
from teamformer.record.export.mcap_file import write_mcap
from teamformer.record.files.reading import read_record
from teamformer.record.files.writing import record_to_tree
from teamformer.record.referee import judge
from teamformer.viewer.html import write_page

pytest.importorskip("uvicorn", reason="the extra `live` is not installed")
from teamformer.live.serving.doors import PromptRequests

client = pytest.importorskip("websockets.sync.client")
closed = pytest.importorskip("websockets.exceptions")


@pytest.fixture
def served(tmp_path: Path) -> Iterator[Served]:
    with serving(small_mission(), tmp_path / "out") as server:
        yield server


class Page:
    """What a browser's page does, without the browser."""

    def __init__(self, server: Served, origin: str | None = None, query: str = "") -> None:
        uri = f"ws://{server.address}/socket{query}"
        self._opening = client.connect(uri, origin=origin or f"http://{server.address}")

    def __enter__(self) -> Page:
        self.socket = self._opening.__enter__()
        return self

    def __exit__(self, *problem: Any) -> None:
        self._opening.__exit__(*problem)

    def ask(self, **message: Any) -> None:
        self.socket.send(json.dumps(message))

    def hear(self, kind: str) -> dict[str, Any]:
        """Return the next message of a kind; others are passed over."""
        while (message := self.hear_any())["kind"] != kind:
            pass
        return message

    def hear_any(self) -> dict[str, Any]:
        """Return the next message."""
        return dict(json.loads(self.socket.recv(timeout=20)))


def get(server: Served, host: str, path: str = "/") -> tuple[int, str]:
    status, content = fetch(server, host, path)
    return status, content.decode()


def fetch(server: Served, host: str, path: str) -> tuple[int, bytes]:
    connection = http.client.HTTPConnection("127.0.0.1", server.port)
    connection.request("GET", path, headers={"Host": host})
    with closing(connection), connection.getresponse() as answer:
        return answer.status, answer.read()


def test_the_page_comes_to_its_own_host_only(served: Served) -> None:
    status, page = get(served, served.address)
    assert status == 200
    assert "connect-src 'self'" in page
    assert get(served, "evil.example") == (
        403,
        "this server does not answer to 'evil.example'; if it is yours, add it with --host\n",
    )


def test_pages_of_other_sites_cannot_speak_to_it(served: Served) -> None:
    for origin in ("http://evil.example", "http://localhost:80", "null", "http://["):
        with pytest.raises(closed.InvalidStatus), Page(served, origin=origin):
            pass


def test_a_server_with_a_token_wants_it(tmp_path: Path) -> None:
    with serving(small_mission(), tmp_path, token="secret") as server:
        assert get(server, server.address)[0] == 403
        assert get(server, server.address, "/?token=secret")[0] == 200
        for guess in ("?token=guess", "?token=%C3%A9"):
            assert get(server, server.address, f"/{guess}")[0] == 403
            with pytest.raises(closed.InvalidStatus), Page(server, query=guess):
                pass
        with Page(server, query="?token=secret") as page:
            assert page.hear("mission")["record"]["steps"] == []


def test_at_a_wildcard_address_the_token_decides_under_every_name(tmp_path: Path) -> None:
    """As at the machine's own address, a container's published port, or a name of the network."""
    anywhere = HostAndPort("0.0.0.0")
    with serving(small_mission(), tmp_path, token="secret", address=anywhere) as server:
        for host in (server.address, "192.168.1.5:8765", "localhost:9000", "desk.lan", "[fe80::1]"):
            assert get(server, host, "/?token=secret")[0] == 200
            assert get(server, host)[0] == 403
        with Page(server, query="?token=secret") as page:
            assert page.hear("mission")
        with (
            pytest.raises(closed.InvalidStatus),
            Page(server, "http://evil.example", "?token=secret"),
        ):
            pass


def test_a_tunnel_and_a_proxy_are_let_in_under_the_names_given(tmp_path: Path) -> None:
    """One leaves the name as it is, the other asks for the server's own."""
    behind = address_of("8765", ("Teams.Example",))
    with serving(small_mission(), tmp_path, token="secret", address=behind) as server:
        for host in ("teams.example", "teams.example:8443", server.address):
            assert get(server, host, "/?token=secret")[0] == 200
        assert get(server, "other.example", "/?token=secret")[0] == 403
        with Page(server, "https://teams.example", "?token=secret") as page:
            assert page.hear("mission")


def test_a_tunnel_may_end_at_another_port(served: Served) -> None:
    """As `ssh -L 9000:localhost:8765` makes one."""
    assert get(served, "localhost:9000")[0] == 200


@pytest.mark.parametrize("path", ["/", "/download/mission.yaml", "/download/none", "/none"])
def test_no_other_page_may_frame_an_answer_or_guess_its_type(served: Served, path: str) -> None:
    connection = http.client.HTTPConnection("127.0.0.1", served.port)
    with closing(connection):
        connection.request("GET", path)
        headers = connection.getresponse().headers
    assert headers["Content-Security-Policy"] == "frame-ancestors 'none'"
    assert headers["X-Frame-Options"] == "DENY"
    assert headers["X-Content-Type-Options"] == "nosniff"


@pytest.mark.parametrize("sent", [b"", b"GET / HTTP/1.1\r\nHost: ", b"GET / HTTP/1.1\r\n\r\nGET"])
def test_a_connection_that_asks_for_nothing_is_closed(
    served: Served, monkeypatch: pytest.MonkeyPatch, sent: bytes
) -> None:
    """Whether it says nothing, begins a first request, or a second one."""
    monkeypatch.setattr(PromptRequests, "limit", 0.05)
    with socket.create_connection(("127.0.0.1", served.port), timeout=20) as connection:
        connection.sendall(sent)
        while connection.recv(1000):
            pass


def test_a_page_that_only_listens_is_not_closed(
    served: Served, monkeypatch: pytest.MonkeyPatch
) -> None:
    waiting: list[PromptRequests] = []
    monkeypatch.setattr(PromptRequests, "_wait", lambda connection: waiting.append(connection))
    with Page(served) as page:
        [connection] = waiting
        connection.loop.call_soon_threadsafe(connection._close_if_idle)
        page.ask(do="step")
        assert page.hear("step")["at"] == 1


def test_a_mission_is_played_and_everybody_is_told(served: Served) -> None:
    with Page(served) as page, Page(served) as other:
        page.hear("mission")
        other.hear("mission")
        page.ask(do="play")
        seen = [[watcher.hear("step") for _ in range(13)] for watcher in (page, other)]
        assert seen[0] == seen[1]
        assert [step["at"] for step in seen[0]] == list(range(1, 14))
        assert seen[0][-1]["end"]["status"] == "completed"
        page.ask(do="speed", speed=3)
        assert other.hear("state")["speed"] in (3, 20)
    assert served.session.mission.steps == 13


def test_an_incident_is_told_before_there_is_a_plan_for_it(
    served: Served, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The mission waits in the middle of its planning until the page has heard what happened."""
    is_heard, happen = threading.Event(), served.session.mission.happen

    def wait_and_happen(incident: Any) -> None:
        assert is_heard.wait(20)
        happen(incident)

    monkeypatch.setattr(served.session.mission, "happen", wait_and_happen)
    with Page(served) as page:
        page.hear("mission")
        page.ask(do="happen", lost="r2")
        while not (state := page.hear("state"))["planning"]:
            pass
        assert state["planning"] == "step 1: robot r2 lost"
        assert state["leaving"] == ["r2"]
        is_heard.set()
        incident = page.hear("incident")
        assert incident["planning"] == ""
        assert incident["is_loss"]
        assert incident["leaving"] == ["r2"]
        page.ask(do="step")
        assert page.hear("step")["step"]["lost"] == [1]


def test_an_incident_is_told_together_with_the_record_that_has_it(served: Served) -> None:
    with Page(served) as page:
        page.hear("mission")
        known = 0
        for ask in (
            {"do": "happen", "lost": "r2"},
            {"do": "happen", "back": "r2"},
            {"do": "restart"},
        ):
            page.ask(do="step")
            page.hear("step")
            page.ask(**ask)
            while (told := page.hear_any())["kind"] not in ("incident", "mission"):
                assert len(told.get("incidents", range(known))) == known
            known = len(told["incidents"])
        assert known == 0


def test_what_cannot_happen_is_refused_before_anything_is_planned(
    served: Served, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(served.session.mission, "happen", lambda incident: pytest.fail("planned"))
    with Page(served) as page:
        page.hear("mission")
        page.ask(do="happen", lost="r9")
        assert page.hear("refused")["text"] == "there is no robot 'r9'"


def test_the_lower_bound_is_that_of_a_run(served: Served) -> None:
    with Page(served) as page:
        page.hear("mission")
        bound = lower_bound(small_mission())
        assert page.hear("bound")["lower_bound"] == bound
        page.ask(do="happen", task={"at": [0, 2], "needs": {"scan": 1}, "duration": 40})
        assert page.hear("incident")["record"]["lower_bound"] is None
        told = page.hear("bound")["lower_bound"]
        assert told == lower_bound(served.session.mission.source) > bound
        page.ask(do="save")
        record = Path(page.hear("saved")["paths"][0])
        assert read_record(record).lower_bound == told


def test_incidents_happen_and_the_saved_record_is_legal(served: Served) -> None:
    with Page(served) as page:
        page.hear("mission")
        told = page.hear("forecast")
        assert (told["status"], told["steps"]) == ("completed", 13)
        ends = told["done_at"]
        assert max(ends) == 13
        for _ in range(4):
            page.ask(do="step")
            page.hear("step")
        page.ask(do="what_if", lost="r2")
        guess = page.hear("what_if")
        assert guess["at"] == 4
        assert guess["without"] == {"status": "completed", "steps": 13}
        assert guess["text"] == "robot r2 lost"
        page.ask(do="happen", lost="r2")
        assert page.hear("incident")["record"]["mission"]["robots"][1]["lost"] == 5
        page.ask(do="happen", task={"at": [3, 1], "needs": ["lift"], "name": "extra"})
        page.hear("incident")
        page.ask(do="play")
        while "end" not in page.hear("step"):
            pass
        page.ask(do="save")
        record = read_record(Path(page.hear("saved")["paths"][0]))
    assert judge(record).findings == ()
    assert record.end.status == "completed"
    assert guess["steps"] <= record.end.steps
    assert [task.name for task in record.mission.tasks] == ["a", "b", "c", "extra"]


class Long:
    """Work that goes on until a test lets it end, or nobody wants to know any more."""

    def __init__(self) -> None:
        self.is_begun, self.may_end = threading.Event(), threading.Event()
        self.was_given_up = threading.Event()

    def __call__(self, now: RunningMission, incident: Incident, is_over: IsOver) -> WhatIf:
        self.is_begun.set()
        while not self.may_end.wait(0.01):
            if is_over():
                self.was_given_up.set()
                break
        return what_if(now, incident, is_over)

    def clear(self) -> None:
        self.is_begun.clear()
        self.was_given_up.clear()


@pytest.fixture
def long(monkeypatch: pytest.MonkeyPatch) -> Long:
    """What the playing ahead of an incident takes until a test lets it end."""
    work = Long()
    monkeypatch.setattr("teamformer.live.session.what_if", work)
    return work


def test_a_page_is_heard_while_what_it_weighs_is_worked_out(served: Served, long: Long) -> None:
    with Page(served) as page:
        page.hear("mission")
        page.ask(do="step")
        page.ask(do="what_if", lost="r2")
        assert long.is_begun.wait(20)
        page.ask(do="play")
        page.hear("step")
        page.ask(do="pause")
        while page.hear("state")["is_playing"]:
            pass
        page.ask(do="save")
        page.hear("saved")
        assert not long.may_end.is_set()
        long.may_end.set()
        assert page.hear("what_if")["at"] == 1  # the step that it was asked in
        assert served.session.mission.steps > 1


def test_what_is_weighed_ends_when_one_stops_it_leaves_or_something_happens(
    served: Served, long: Long
) -> None:
    with Page(served) as other, Page(served) as page:
        page.hear("mission")
        page.ask(do="what_if", lost="r2")
        assert long.is_begun.wait(20)
        page.ask(do="stop")
        page.hear("stopped")
        assert long.was_given_up.wait(20)
        long.clear()
        page.ask(do="what_if", lost="r2")
        assert long.is_begun.wait(20)
        other.ask(do="happen", lost="r1")
        told = page.hear("refused")
        assert told["text"] == "something else has happened meanwhile; ask again"
        assert told["is_weighed"]
        assert long.was_given_up.wait(20)
        page.ask(do="undo")
        assert page.hear("mission")["incidents"] == []
        long.clear()
        page.ask(do="what_if", lost="r2")
        assert long.is_begun.wait(20)
    assert long.was_given_up.wait(20)


def test_what_is_asked_in_one_go_is_done_in_that_order(served: Served) -> None:
    """Two tasks without a name get one each, the second beside the first."""
    with Page(served) as page:
        page.hear("mission")
        for at in ([1, 1], [2, 1]):
            page.ask(do="happen", task={"at": at, "needs": ["lift"]})
        page.ask(do="step")
        page.ask(do="undo")
        page.hear("incident")
        assert [text for _, text in page.hear("incident")["incidents"]] == [
            "task t4 at [1, 1] that needs lift",
            "task t5 at [2, 1] that needs lift",
        ]
        assert page.hear("step")["at"] == 1
        told = page.hear("mission")
        assert (len(told["incidents"]), told["record"]["steps"]) == (1, [])


def test_a_search_for_a_plan_can_be_stopped(tmp_path: Path) -> None:
    with (
        serving(small_mission(), tmp_path, method="plan") as server,
        Page(server) as page,
        Page(server) as other,
    ):
        page.ask(do="replan", seconds=120)
        other.hear("searching")
        other.ask(do="stop")
        page.hear("stopped")
        page.ask(do="take_over")
        assert "there is no plan to take over" in page.hear("refused")["text"]


@pytest.mark.parametrize("method", ["plan", "join-fitting"])
def test_who_asks_what_a_loss_costs_is_told_how_much_is_luck_where_there_are_plans(
    tmp_path: Path, method: str
) -> None:
    with serving(small_mission(), tmp_path, method=method) as server, Page(server) as page:
        page.hear("mission")
        page.ask(do="what_if", lost="r1")
        told = page.hear("what_if")
        assert told["is_planned"] == (method == "plan")
        if told["is_planned"]:  # a mission so small is planned alike in any order
            assert page.hear("luck") == {"kind": "luck", "steps": 0.0, "is_luck": False}


def test_a_plan_is_searched_for_offered_and_taken_over(tmp_path: Path) -> None:
    with (
        serving(small_mission(), tmp_path, method="plan") as server,
        Page(server) as page,
        Page(server) as other,
    ):
        page.hear("mission")
        for _ in range(2):
            page.ask(do="step")
            page.hear("step")
        page.ask(do="replan", seconds=0.2)
        page.ask(do="replan")
        assert "is being searched for already" in page.hear("refused")["text"]
        offer = other.hear("offer")
        assert page.hear("offer") == offer
        assert (offer["at"], offer["without"]) == (2, {"status": "completed", "steps": 13})
        assert offer["steps"] <= 13
        page.ask(do="take_over")
        told = other.hear("incident")
        assert told["text"].startswith("step 2: plan of central taken over: done after")
        assert told["record"]["plans"][-1][:1] == [2]
        assert told["record"]["plans"][-1][1][0] == ["taken over"]
        assert other.hear("forecast")["steps"] == offer["steps"]
        page.ask(do="replan", seconds=0)
        page.hear("offer")
        page.ask(do="step")
        page.ask(do="take_over")
        assert "the mission has gone on since then" in page.hear("refused")["text"]
        page.ask(do="save")
        saved = page.hear("saved")
        assert "a mission holds no plans" in saved["note"]
    assert judge(read_record(Path(saved["paths"][0]))).findings == ()


def test_a_plan_for_robots_that_go_by_none_is_refused(tmp_path: Path) -> None:
    with serving(small_mission(), tmp_path) as server, Page(server) as page:
        page.ask(do="replan", seconds=0)
        assert "with this method robots follow no plan" in page.hear("refused")["text"]


@pytest.mark.thorough
def test_an_uncertain_mission_is_forecast_as_a_band(tmp_path: Path) -> None:
    mission = small_mission()
    tasks = tuple(replace(task, lasts=(1, 9)) for task in mission.tasks)
    unsure = replace(mission, tasks=tasks, step_limit=0)
    with serving(unsure, tmp_path, method="plan") as server, Page(server) as page:
        told = page.hear("forecast")
        assert told["futures"] == told["done"] == 40
        low, high = told["band"]
        assert 10 < low <= told["steps"] <= high
        assert low < high
        page.ask(do="what_if", lost="r2")
        assert page.hear("what_if")["without"]["band"] == [low, high]
        page.ask(do="play")
        late = page.hear("forecast")  # once the first task is done
        assert late["band"][0] >= low
        assert late["band"] != [low, high]


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("{", "the message is no JSON"),
        ("[" * 100_000, "the message is no JSON"),
        ("[]", "the message has no 'do'"),
        ('{"do": "explode"}', "the message has no 'do'"),
        ('{"do": "speed", "speed": "fast"}', "speed must be a number from 0.1 to 1000"),
        ('{"do": "speed", "speed": NaN}', "speed must be a number from 0.1 to 1000"),
        ('{"do": "happen"}', "an incident needs 'lost', 'back', 'cancelled'"),
        ('{"do": "happen", "lost": "r9"}', "there is no robot 'r9'"),
        ('{"do": "happen", "task": {"at": [5, 1], "needs": ["lift"]}}', "inside an obstacle"),
        ('{"do": "happen", "task": {"at": [1, 1], "needs": ["fly"]}}', "not under capabilities"),
        ('{"do": "happen", "task": {"at": [1.5, 1], "needs": ["lift"]}}', "write a whole number"),
        ('{"do": "happen", "task": {"at": [1, 1], "needs": {"lift": 9}}}', "together have"),
        ('{"do": "happen", "task": {"at": [1, 1], "needs": []}}', "nothing"),
        ('{"do": "happen", "task": {"at": [1, 1], "needs": ["lift"], "name": "a"}}', "used twice"),
        ('{"do": "open"}', "cannot 'open'"),
        ('{"do": "take_over"}', "there is no plan to take over"),
        ('{"do": "replan", "seconds": -1}', "seconds must be a number from 0 to 120"),
        ('{"do": "replan", "seconds": true}', "seconds must be a number from 0 to 120"),
    ],
)
def test_what_makes_no_sense_is_refused_and_changes_nothing(
    served: Served, text: str, told: str
) -> None:
    with Page(served) as page:
        page.hear("mission")
        page.socket.send(text)
        assert told in page.hear("refused")["text"]
        page.ask(do="step")
        assert page.hear("step")["at"] == 1
    assert served.session.mission.incidents == []


def test_a_message_that_is_too_large_ends_only_that_line(served: Served) -> None:
    with Page(served) as page:
        page.hear("mission")
        page.socket.send("x" * 5_000_000)
        with pytest.raises(closed.ConnectionClosed):
            page.hear("refused")
    with Page(served) as page:
        assert page.hear("mission")["record"]["steps"] == []


def test_bytes_and_vanished_pages_do_no_harm(served: Served) -> None:
    with Page(served) as page:
        page.hear("mission")
        page.socket.send(b"\x00\xff")
    with Page(served) as gone:
        gone.hear("mission")
        gone.socket.socket.close()  # without a word
    with Page(served) as other:
        other.ask(do="play")
        assert other.hear("step")["at"] == 1


def test_ending_the_server_saves_what_was_done(tmp_path: Path) -> None:
    with serving(small_mission(), tmp_path / "out") as server, Page(server) as page:
        page.ask(do="step")
        page.hear("step")
    record = read_record(tmp_path / "out" / "record.json")
    assert (record.end.status, len(record.steps)) == ("interrupted", 1)


def test_a_port_in_use_is_refused_with_another(tmp_path: Path) -> None:
    from teamformer.cli.verbs.missions.live import LiveOptions, live
    from teamformer.files.mission_files import write_mission

    path = tmp_path / "small.yaml"
    write_mission(small_mission(), path)
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        options = LiveOptions("join-fitting", 0, HostAndPort("127.0.0.1", port), tmp_path / "out")
        with pytest.raises(TeamformerError, match=f"127.0.0.1:{port} cannot be used") as error:
            live(path, options)
    assert "--port" in (error.value.hint or "")


def test_an_address_is_a_port_with_or_without_a_host() -> None:
    assert address_of("80") == HostAndPort("127.0.0.1", 80)
    assert address_of("0.0.0.0:8765") == HostAndPort("0.0.0.0", 8765)
    assert address_of("[::1]:8765") == HostAndPort("::1", 8765)
    for wrong in ("", "web", "0", "65536", "8765:"):
        with pytest.raises(TeamformerError, match="is no port"):
            address_of(wrong)
    for wrong in ("http://teams.example", "teams.example:80", "[", ""):
        with pytest.raises(TeamformerError, match="is no name of a host"):
            address_of("80", (wrong,))


def test_an_address_that_is_printed_can_be_opened(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(addresses, "_own_address", lambda family: "192.168.1.5")
    assert address_of("0.0.0.0:80").to_open() == ["http://127.0.0.1:80/", "http://192.168.1.5:80/"]
    assert address_of("desk:80").to_open() == ["http://desk:80/"]
    monkeypatch.setattr(addresses, "_own_address", lambda family: None)  # without a network
    assert address_of("[::]:80").to_open() == ["http://[::1]:80/"]


def test_only_a_server_for_this_machine_alone_needs_no_token() -> None:
    assert address_of("localhost:80").is_here_only
    assert not address_of("0.0.0.0:80").is_here_only
    assert not address_of("80", ("teams.example",)).is_here_only


def test_an_incident_is_undone_and_the_mission_restarted(served: Served) -> None:
    with Page(served) as page, Page(served) as other:
        page.ask(do="undo")
        assert page.hear("refused")["text"] == "nothing has happened that could be undone"
        page.ask(do="step")
        page.ask(do="happen", lost="r1")
        page.ask(do="step")
        while other.hear("step")["at"] != 2:
            pass
        page.ask(do="undo")
        told = other.hear("mission")
        assert (len(told["record"]["steps"]), told["incidents"]) == (1, [])
        assert "lost" not in told["record"]["mission"]["robots"][0]
        other.ask(do="play")
        while "end" not in (step := page.hear("step")):
            pass
        assert (step["at"], step["end"]["status"]) == (13, "completed")  # as if never disturbed
        page.ask(do="restart")
        told = other.hear("mission")
        assert (told["record"]["steps"], told["is_playing"]) == ([], False)
        assert other.hear("forecast")["steps"] == 13


def test_downloads_are_what_the_command_line_writes(served: Served, tmp_path: Path) -> None:
    with Page(served) as page:
        page.hear("mission")
        page.ask(do="step")
        page.ask(do="happen", task={"at": [3, 1], "needs": ["lift"], "name": "extra"})
        page.hear("incident")
        page.ask(do="play")
        while "end" not in page.hear("step"):
            pass
        page.ask(do="save")
        saved, mission = map(Path, page.hear("saved")["paths"])
    record = read_record(saved)

    def content(name: str) -> bytes:
        status, came = fetch(served, served.address, f"/download/{name}")
        assert status == 200, came
        return came

    assert content("record.json") == saved.read_bytes()
    assert content("mission.yaml") == mission.read_bytes()
    write_page(record_to_tree(record), tmp_path / "page.html")
    assert content("record.html") == (tmp_path / "page.html").read_bytes()
    with zipfile.ZipFile(io.BytesIO(content("tables.zip"))) as tables:
        for path in write_tables(record, tmp_path):
            assert tables.read(path.name) == path.read_bytes()
    write_mcap(record, tmp_path / "it.mcap")
    (tmp_path / "came.mcap").write_bytes(content("record.mcap"))
    told = messages_of(tmp_path / "came.mcap")
    assert told == messages_of(tmp_path / "it.mcap")
    assert len(told) > 13
    assert fetch(served, "evil.example", "/download/record.json")[0] == 403
    assert fetch(served, served.address, "/download/secrets")[0] == 404


def messages_of(path: Path) -> list[tuple[str, int, bytes]]:
    """Return the messages of a file: topic, time and content."""
    reader = pytest.importorskip("mcap.reader")
    with path.open("rb") as stream:
        found = reader.make_reader(stream).iter_messages()
        return [(channel.topic, it.log_time, it.data) for _, channel, it in found]


class Slow:
    """Makes missions once it may, so that a test looks at the server meanwhile."""

    def __init__(self) -> None:
        self.may_start = threading.Event()
        self.has_ended = False

    def __call__(self, mission: Mission) -> RunningMission:
        self.may_start.wait(20)
        self.has_ended = True
        if len(mission.robots) == 1:
            raise TeamformerError("one robot is too few for this method")
        return RunningMission(mission, lambda: load_method("join-fitting"), 0)


def test_pages_are_served_before_the_first_plan_is_made(tmp_path: Path) -> None:
    start, said = Slow(), list[str]()
    tree = mission_to_tree(small_mission())
    shop = Workshop(start, tmp_path, 20.0, Draft(tree, "small.yaml"), small_mission(), said.append)
    with serving_session(shop) as server:
        with Page(server) as page:
            assert page.hear("starting")["mission"]["name"] == "small"
            assert fetch(server, server.address, "/download/record.json")[0] == 404
            while not said:
                time.sleep(0.01)
            start.may_start.set()
            page.hear("begun")
        assert said[0] == "making the first plan ..."
        assert re.fullmatch(r"the mission is ready after [\d.]+ s; the page starts it", said[1])
        with Page(server) as page:
            assert page.hear("mission")["has_editor"]
            page.ask(do="step")
            page.hear("step")
            page.ask(do="edit")
            page.hear("begun")
        with Page(server) as page:  # the drawing is as it was
            draft = page.hear("editor")
            assert (draft["mission"], draft["file"]) == (tree, "small.yaml")
            alone = tree | {"robots": tree["robots"][2:]}
            page.ask(do="run", mission=alone)
            assert page.hear("refused")["text"] == "one robot is too few for this method"
        with Page(server) as page:
            assert len(page.hear("editor")["mission"]["robots"]) == 1
            page.ask(do="run", mission=tree)
            page.hear("begun")
        with Page(server) as page:
            assert page.hear("mission")["record"]["steps"] == []


@pytest.fixture
def editor(tmp_path: Path) -> Iterator[Served]:
    with serving_editor(tmp_path / "out") as server:
        yield server


def test_what_one_page_draws_all_pages_show(editor: Served) -> None:
    with Page(editor) as one, Page(editor) as other:
        tree, first = one.hear("editor")["mission"], other.hear("editor")["id"]
        drawn = tree | {"name": "drawn"}
        one.ask(do="check", mission=drawn, id="a1", after=first)
        assert one.hear("checked") == {"kind": "checked", "problems": [], "id": "a1"}
        told = other.hear("editor")
        assert (told["mission"], told["id"]) == (drawn, "a1")
        other.ask(do="check", mission=tree, id="b1", after="a1")
        assert one.hear("editor")["mission"] == tree
        one.ask(do="new")
        assert other.hear("editor")["mission"]["robots"] == []


@pytest.mark.parametrize("command", ["check", "save", "run"])
def test_no_page_draws_over_what_it_has_not_seen(
    editor: Served, command: str, tmp_path: Path
) -> None:
    """Whoever is late is shown the drawing of the other; what follows its own is late too."""
    with Page(editor) as one, Page(editor) as other:
        tree, first = one.hear("editor")["mission"], other.hear("editor")["id"]
        mine, yours = tree | {"name": "mine"}, tree | {"name": "yours"}
        one.ask(do="check", mission=mine, id="a1", after=first)
        one.hear("checked")
        for own, after in (("b1", first), ("b2", "b1")):
            other.ask(do=command, mission=yours, id=own, after=after, name="it.yaml")
            assert other.hear("editor")["mission"] == mine
            assert "another page has changed the drawing" in other.hear("refused")["text"]
        other.ask(do="check", mission=yours, id="b3", after="a1")
        assert one.hear("editor")["mission"] == yours
    assert list(tmp_path.rglob("*.yaml")) == []


def test_a_server_ends_while_a_first_plan_is_made(tmp_path: Path) -> None:
    start = Slow()
    tree = mission_to_tree(small_mission())
    shop = Workshop(start, tmp_path, 20.0, Draft(tree), small_mission())
    with serving_session(shop) as server, Page(server) as page:
        page.hear("starting")
    assert not start.has_ended
    start.may_start.set()
    assert list(tmp_path.iterdir()) == []  # nothing was done that could be saved
