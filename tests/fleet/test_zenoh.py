"""The network of processes: who is heard by whom, over real sessions on this machine."""

from __future__ import annotations

import shutil
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from teamformer.fleet.messages import EVERYBODY, OPERATOR
from teamformer.fleet.process.fleet import free_ports
from teamformer.fleet.transports.keys import Certificates, read_keys
from teamformer.fleet.transports.zenoh_mesh import ZenohTransport

LIMIT = 30.0
"""Seconds after which a test fails; it waits only for what is to come."""


@contextmanager
def transports(
    *robots: int,
    certificates: tuple[Certificates | None, ...] = (),
    missions: tuple[int, ...] = (),
) -> Iterator[list[ZenohTransport]]:
    """Return transports of which each dials all before it."""
    link = "tls" if certificates else "tcp"
    endpoints = [f"{link}/127.0.0.1:{port}" for port in free_ports(len(robots))]
    made: list[ZenohTransport] = []
    try:
        for place, robot in enumerate(robots):
            shown = certificates[place] if certificates else None
            ends = (endpoints[place], endpoints[:place])
            mission = missions[place] if missions else 7
            made.append(ZenohTransport(mission, robot, *ends, certificates=shown))
        yield made
    finally:
        for each in made:
            each.close()


def heard(listener: ZenohTransport, wanted: bytes, say: Callable[[], None]) -> set[bytes]:
    """Let things be said again and again until the wanted is heard; return all that was."""
    came: set[bytes] = set()
    deadline = time.monotonic() + LIMIT
    while wanted not in came:
        assert time.monotonic() < deadline, came
        say()
        came |= set(listener.receive(0.05))
    return came


def test_who_is_not_listened_to_is_not_heard() -> None:
    with transports(0, 1, 2) as (first, second, third):
        first.listen_to({2})

        def say() -> None:
            second.send(EVERYBODY, b"from 1")
            second.send(0, b"from 1 to 0")
            third.send(EVERYBODY, b"from 2")

        assert heard(first, b"from 2", say) <= {b"from 2", b"from 1 to 0"}
        first.listen_to({1})
        heard(first, b"from 1", say)
        first.receive(0.0)
        say()
        assert b"from 2" not in heard(first, b"from 1", say)


def test_operators_are_heard_by_all_and_so_is_who_has_dialled_anew() -> None:
    with transports(0, OPERATOR) as (robot, operator):
        heard(robot, b"offer", lambda: operator.send(EVERYBODY, b"offer"))
        operator.listen_to({0})
        operator.listen_to_body("reports/0")
        operator._reopen()
        heard(operator, b"word", lambda: robot.send(EVERYBODY, b"word"))
        heard(robot, b"again", lambda: operator.send(EVERYBODY, b"again"))
        deadline = time.monotonic() + LIMIT
        while not operator.receive_body():
            assert time.monotonic() < deadline
            robot.send_body("reports/0", b"here")
            operator.receive(0.05)


def test_robots_of_another_mission_are_heard_so_that_it_can_be_told() -> None:
    with transports(0, 1, missions=(7, 8)) as (robot, stranger):
        robot.listen_to({1})

        def say() -> None:
            stranger.send(0, b"to 0 of mission 8")
            stranger.send_body("reports/0", b"here")
            stranger.send(EVERYBODY, b"word")

        assert heard(robot, b"word", say) == {b"word"}
        assert robot.receive_body() == []


def openssl(*words: str, folder: Path) -> None:
    subprocess.run(["openssl", *words], cwd=folder, check=True, capture_output=True)


def make_certificates(folder: Path) -> Certificates | None:
    """Return a certificate for this machine, signed by an authority of its own."""
    folder.mkdir()
    (folder / "names").write_text("subjectAltName=IP:127.0.0.1")
    curve = ("-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes")
    own = ("-subj", "/CN=fleet", "-keyout", "ca-key.pem", "-out", "ca.pem")
    openssl("req", "-x509", *curve, *own, folder=folder)
    asked = ("-subj", "/CN=robot", "-keyout", "key.pem", "-out", "asked")
    openssl("req", *curve, *asked, folder=folder)
    signed = ("-CA", "ca.pem", "-CAkey", "ca-key.pem", "-extfile", "names")
    openssl("x509", "-req", "-in", "asked", *signed, "-out", "certificate.pem", folder=folder)
    return read_keys(folder).certificates


@pytest.mark.skipif(shutil.which("openssl") is None, reason="openssl makes the certificates")
def test_over_tls_only_who_shows_a_certificate_of_the_fleet_is_heard(tmp_path: Path) -> None:
    fleet, foreign = make_certificates(tmp_path / "fleet"), make_certificates(tmp_path / "foreign")
    with transports(0, 1, 2, certificates=(fleet, fleet, foreign)) as (first, second, third):
        first.listen_to({1, 2})

        def say() -> None:
            second.send(EVERYBODY, b"friend")
            third.send(EVERYBODY, b"stranger")

        came = heard(first, b"friend", say)
        for _ in range(10):
            say()
            came |= set(first.receive(0.05))
        assert came == {b"friend"}
