"""The folder of a fleet's keys: what is there is used, what is half there is told."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from fleets import trio
from teamformer.base.errors import TeamformerError
from teamformer.fleet.messages import OPERATOR
from teamformer.fleet.transports.keys import CERTIFICATES, Keys, read_keys

SECRET = b"0123456789abcdef"


def test_without_a_folder_there_are_no_keys() -> None:
    assert read_keys(None) == Keys()
    assert Keys().signatures(trio(), 0) is None


def test_everything_in_one_folder_is_used(tmp_path: Path) -> None:
    (tmp_path / "shared.key").write_bytes(SECRET + b"\n")
    assert read_keys(tmp_path) == Keys(SECRET)
    for name in CERTIFICATES:
        (tmp_path / name).write_text("PEM")
    certificates = read_keys(tmp_path).certificates
    assert certificates is not None
    assert certificates.key == tmp_path / "key.pem"
    assert read_keys(tmp_path).signers is None
    for name in ("r0", "r1", "r2", "operator"):
        make = f"openssl genpkey -algorithm ed25519 -out {name}.key"
        show = f"openssl pkey -in {name}.key -pubout -out {name}.pub"
        for command in (make, show):
            subprocess.run(command.split(), cwd=tmp_path, check=True, capture_output=True)
    keys = read_keys(tmp_path)
    assert (keys.secret, keys.certificates, keys.signers) == (SECRET, certificates, tmp_path)
    for who in (0, 2, OPERATOR, None):
        assert keys.signatures(trio(), who) is not None


@pytest.mark.parametrize(
    ("names", "told"),
    [
        ((), "no key of a fleet is in this folder"),
        (("key.pem",), "ca.pem is absent"),
        (("ca.pem", "key.pem"), "certificate.pem is absent"),
        (("ca.pem", "certificate.pem"), "key.pem is absent"),
        (("r0.key",), "r0.key is there without r0.pub"),
        (("r0.pub", "r1.key"), "r1.key is there without r1.pub"),
    ],
)
def test_what_is_half_there_is_told(names: tuple[str, ...], told: str, tmp_path: Path) -> None:
    for name in names:
        (tmp_path / name).write_text("PEM")
    with pytest.raises(TeamformerError, match=told) as error:
        read_keys(tmp_path)
    assert error.value.hint


def test_a_robot_without_a_public_key_is_told(tmp_path: Path) -> None:
    (tmp_path / "r1.pub").write_text("PEM")
    with pytest.raises(TeamformerError, match=r"r0\.pub: cannot be read"):
        read_keys(tmp_path).signatures(trio(), 0)


def test_a_folder_that_is_not_there_is_told(tmp_path: Path) -> None:
    with pytest.raises(TeamformerError, match="none: cannot be read: No such file"):
        read_keys(tmp_path / "none")


def test_a_short_key_is_refused(tmp_path: Path) -> None:
    (tmp_path / "shared.key").write_bytes(SECRET[:15] + b"\n")
    with pytest.raises(TeamformerError, match="a key of 15 bytes is too short"):
        read_keys(tmp_path)


@pytest.mark.parametrize("endpoint", ["tcp/127.0.0.1:7447", "tcp/localhost:1", "tcp/[::1]:7"])
def test_this_machine_needs_no_key(endpoint: str) -> None:
    Keys().check([endpoint])


def test_tls_needs_certificates_and_no_key(tmp_path: Path) -> None:
    with pytest.raises(TeamformerError, match="needs certificates"):
        Keys(SECRET).check(["tls/example.org:7447"])
    for name in CERTIFICATES:
        (tmp_path / name).write_text("PEM")
    read_keys(tmp_path).check(["tls/example.org:7447"])


@pytest.mark.parametrize("endpoint", ["tcp/192.168.1.7:7447", "tcp/0.0.0.0:1", "tcp/robot:7"])
def test_beyond_this_machine_a_key_is_needed(endpoint: str) -> None:
    Keys(SECRET).check([endpoint])
    with pytest.raises(TeamformerError, match="would not be protected"):
        Keys().check([endpoint])


@pytest.mark.parametrize("endpoint", ["", "7447", "tcp/", "http/localhost:1"])
def test_what_is_no_endpoint_is_refused(endpoint: str) -> None:
    with pytest.raises(TeamformerError, match="is no endpoint"):
        Keys(SECRET).check([endpoint])
