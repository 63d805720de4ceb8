"""Brokers that want to know who comes, and addresses that say so."""

from __future__ import annotations

import gc
import shutil
import subprocess
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import pytest

from teamformer.base.errors import TeamformerError
from teamformer.fleet.bodies.vda5050.address import Address, read_address
from teamformer.fleet.bodies.vda5050.body import Vda5050Body
from teamformer.fleet.process.fleet import free_ports
from vda5050_vehicle import running, two_vehicles, wait_for_port

needs_mosquitto = pytest.mark.skipif(
    None in (shutil.which("mosquitto"), shutil.which("mosquitto_passwd"), shutil.which("openssl")),
    reason="needs mosquitto and openssl",
)
VEHICLE = "uagv/acme/v1"


@pytest.mark.parametrize(
    ("url", "address"),
    [
        ("mqtt://h/a/b/c", Address("h", 1883, "a", "b", "c")),
        ("mqtts://h/a/b/c", Address("h", 8883, "a", "b", "c", is_encrypted=True)),
        ("mqtt://h:7/a/b/c?map=", Address("h", 7, "a", "b", "c", map="")),
        (
            "mqtt://ann%40acme:p%3A%2F@h:7/a/b/c?map=yard&version=3.0.0",
            Address("h", 7, "a", "b", "c", "ann@acme", "p:/", False, "yard", "3.0.0"),
        ),
        ("mqtt://ann@h/a/b/c", Address("h", 1883, "a", "b", "c", "ann")),
    ],
)
def test_an_address_says_where_and_who(url: str, address: Address) -> None:
    assert read_address(url) == address


@pytest.mark.parametrize(
    "url",
    [
        *("", "mqtt://host", "http://h/a/b/c", "mqtt://h/a/b", "mqtt:///a/b/c"),
        *("mqtt://h:x/a/b/c", "mqtt://h:99999/a/b/c", "mqtt://[h/a/b/c"),
    ],
)
def test_what_is_no_address_is_refused(url: str) -> None:
    with pytest.raises(TeamformerError, match="is no address of a vehicle"):
        Vda5050Body(url, two_vehicles(), 0)


def test_no_message_shows_a_password() -> None:
    with pytest.raises(TeamformerError) as caught:
        read_address("mqtt://ann:se/cr@et@h/a/b/c/d")
    assert str(caught.value) == "--body vda5050:mqtt://...@h/a/b/c/d is no address of a vehicle"


@pytest.mark.parametrize(
    ("url", "told"),
    [
        ("mqtt://h/a/b/c?map=yard&version=2.2", "version of --body vda5050 is '2.2'"),
        ("mqtt://h/a/b/c?map=yard&verison=2.1.0", "--body vda5050 has no key 'verison'"),
        ("mqtt://h/a/b/c?ca=ca.pem", "names ca, but mqtt:// is not encrypted"),
        ("mqtts://h/a/b/c?ca=nowhere.pem", "there is no file 'nowhere.pem'"),
        ("mqtts://h/a/b/c?key=key.pem", "names a key without its certificate"),
    ],
)
def test_what_is_no_setting_is_refused(url: str, told: str) -> None:
    with pytest.raises(TeamformerError, match=told):
        read_address(url)


def test_a_broker_that_is_away_is_told() -> None:
    [port] = free_ports(1)
    with pytest.raises(TeamformerError, match=f"no broker at 127.0.0.1:{port}"):
        Vda5050Body(f"mqtt://127.0.0.1:{port}/{VEHICLE}", two_vehicles(), 0)


@contextmanager
def broker(folder: Path, *settings: str) -> Iterator[int]:
    """Yield the port of a broker that lets in nobody but ann@acme, by her password p:/."""
    [port] = free_ports(1)
    users = folder / "users"
    users.touch(mode=0o600)
    subprocess.run(["mosquitto_passwd", "-b", users, "ann@acme", "p:/"], check=True)
    lines = (f"listener {port} 127.0.0.1", "allow_anonymous false", f"password_file {users}")
    (folder / "broker.conf").write_text("\n".join(("user root", *lines, *settings)) + "\n")
    with running("mosquitto", "-c", str(folder / "broker.conf")):
        wait_for_port(port)
        yield port


@needs_mosquitto
def test_a_broker_lets_in_who_has_a_password_and_tells_others(tmp_path: Path) -> None:
    with broker(tmp_path) as port:
        for user in ("", "ann%40acme@", "ann%40acme:wrong@", "bob:p%3A%2F@"):
            with pytest.raises(TeamformerError) as caught:
                Vda5050Body(f"mqtt://{user}127.0.0.1:{port}/{VEHICLE}", two_vehicles(), 0)
            told = f"the broker at 127.0.0.1:{port} refuses this end: Not authorized"
            assert str(caught.value) == told
            assert "USER:PASSWORD" in caught.value.hint
        Vda5050Body(
            f"mqtt://ann%40acme:p%3A%2F@127.0.0.1:{port}/{VEHICLE}", two_vehicles(), 0
        ).close()


@needs_mosquitto
def test_a_broker_that_goes_and_comes_back_is_told(capfd: pytest.CaptureFixture[str]) -> None:
    [port] = free_ports(1)
    told: list[str] = []
    with ExitStack() as stack:
        with running("mosquitto", "-p", str(port)):
            wait_for_port(port)
            body = Vda5050Body(f"mqtt://127.0.0.1:{port}/{VEHICLE}", two_vehicles(), 0)
            stack.callback(body.close)
        stack.enter_context(running("mosquitto", "-p", str(port)))
        for _ in range(200):
            told += capfd.readouterr().err.splitlines()
            if len(told) == 2:
                break
            time.sleep(0.05)
    broker = f"v1: the broker at 127.0.0.1:{port}"
    assert told[0].startswith(f"{broker} has closed the connection: ")
    assert told[0].endswith("; it is tried again")
    assert told[1:] == [f"{broker} is there again"]


@needs_mosquitto
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_an_encrypted_broker_has_to_show_who_it_is(tmp_path: Path) -> None:
    """By a certificate of an authority that is named, and to this end by one of its own."""
    make_certificates(tmp_path)
    files = {"cafile": "ca.pem", "certfile": "broker.pem", "keyfile": "broker.key"}
    settings = [f"{key} {tmp_path / name}" for key, name in files.items()]
    with broker(tmp_path, *settings, "require_certificate true") as port:
        url = f"mqtts://ann%40acme:p%3A%2F@127.0.0.1:{port}/{VEHICLE}"
        ca, certificate, key = (tmp_path / name for name in ("ca.pem", "ann.pem", "ann.key"))
        with pytest.raises(TeamformerError, match="CERTIFICATE_VERIFY_FAILED") as caught:
            Vda5050Body(url, two_vehicles(), 0)
        assert "?ca=FILE" in caught.value.hint
        with pytest.raises(TeamformerError, match=f"the broker at 127.0.0.1:{port}") as caught:
            Vda5050Body(f"{url}?ca={ca}", two_vehicles(), 0)
        assert "certificate=FILE" in caught.value.hint
        with pytest.raises(TeamformerError, match=f"the broker at 127.0.0.1:{port}") as caught:
            Vda5050Body(url.replace("mqtts", "mqtt"), two_vehicles(), 0)
        assert "mqtts://" in caught.value.hint
        Vda5050Body(f"{url}?ca={ca}&certificate={certificate}&key={key}", two_vehicles(), 0).close()
    del caught
    gc.collect()  # paho leaves the socket open whose handshake failed, which is warned of here


def make_certificates(folder: Path) -> None:
    """Write an authority, and what it signed: the broker at 127.0.0.1, and ann."""
    curve = "-newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes"
    words = [f"req -x509 {curve} -subj /CN=plant -days 2 -keyout ca.key -out ca.pem"]
    (folder / "names").write_text("subjectAltName=IP:127.0.0.1\n")
    for name in ("broker", "ann"):
        words.append(f"req {curve} -subj /CN={name} -keyout {name}.key -out {name}.csr")
        signed = "-CA ca.pem -CAkey ca.key -CAcreateserial -days 2 -extfile names"
        words.append(f"x509 -req -in {name}.csr {signed} -out {name}.pem")
    for line in words:
        subprocess.run(["openssl", *line.split()], cwd=folder, check=True, capture_output=True)
