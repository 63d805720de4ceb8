"""The keys of a fleet, in one folder: what is there is used, what is half there is told."""

from __future__ import annotations

import ipaddress
import os
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from teamformer.base.errors import TeamformerError
from teamformer.base.extras import require

if TYPE_CHECKING:
    from teamformer.fleet.fleet_mission import FleetMission
    from teamformer.fleet.signatures import Signatures

SHARED = "shared.key"
SHORTEST_SECRET = 16  # bytes
CERTIFICATES = ("ca.pem", "certificate.pem", "key.pem")
PUBLIC, PRIVATE = ".pub", ".key"


@dataclass(frozen=True)
class Certificates:
    """Files for TLS: who signs this fleet's certificates, the own one, and the key to it."""

    ca: Path
    certificate: Path
    key: Path


@dataclass(frozen=True)
class Keys:
    """What protects the messages of a fleet; empty or None is what the fleet does without.

    `secret` is the key that all share, `certificates` are for `tls/` endpoints, and `signers` is
    the folder with the robots' public keys.
    """

    secret: bytes = b""
    certificates: Certificates | None = None
    signers: Path | None = None

    def signatures(self, mission: FleetMission, who: int | None) -> Signatures | None:
        """Return the signatures of a mission; None if its messages are not signed.

        `who` is a robot's number, OPERATOR, or None for one who only listens. Raises
        `TeamformerError` with the file that is missing or no key.
        """
        if self.signers is None:
            return None
        require("fleet", "cryptography")
        from teamformer.fleet.signatures import read_signatures

        return read_signatures(self.signers, mission.source, mission.number, who)

    def check(self, endpoints: Iterable[str]) -> None:
        """Refuse endpoints beyond this machine at which messages would not be protected.

        They are protected if a shared key seals them, or by TLS. Raises `TeamformerError`, also
        for what is no endpoint.
        """
        for endpoint in endpoints:
            protocol, _, address = endpoint.partition("/")
            if not address or protocol not in ("tcp", "udp", "tls", "quic"):
                raise TeamformerError(
                    f"'{endpoint}' is no endpoint", "write it as in tcp/192.168.1.7:7447"
                )
            is_tls = protocol in ("tls", "quic")
            if is_tls and self.certificates is None:
                raise TeamformerError(
                    f"'{endpoint}' needs certificates",
                    f"name a folder that has {', '.join(CERTIFICATES)} with --keys FOLDER",
                )
            if not self.secret and not is_tls and not _is_loopback(address):
                raise TeamformerError(
                    f"'{endpoint}' is beyond this machine, and messages would not be protected",
                    f"name a folder that has {SHARED} with --keys FOLDER, or use tls/ endpoints",
                )


def read_keys(folder: Path | None) -> Keys:
    """Return the keys in a folder; none without a folder.

    Raises `TeamformerError` for a folder without keys, a key that is too short or cannot be read,
    and for certificates or public keys that are half there.
    """
    if folder is None:
        return Keys()
    try:
        names = {path.name for path in folder.iterdir()}
    except OSError as error:
        hint = f"name a folder that has {SHARED}, certificates or the robots' keys"
        raise TeamformerError(f"{folder}: cannot be read: {error.strerror}", hint) from None
    secret = _read_secret(folder / SHARED) if SHARED in names else b""
    keys = Keys(secret, _certificates(folder, names), _signers(folder, names))
    if keys == Keys():
        hint = f"put {SHARED}, {', '.join(CERTIFICATES)}, or NAME{PUBLIC} of every robot there"
        raise TeamformerError(f"{folder}: no key of a fleet is in this folder", hint)
    return keys


def _read_secret(path: Path) -> bytes:
    hint = "make one with: openssl rand -hex 32"
    try:
        secret = path.read_bytes().strip()
    except OSError as error:
        raise TeamformerError(f"{path}: cannot be read: {error.strerror}", hint) from None
    if len(secret) < SHORTEST_SECRET:
        raise TeamformerError(f"{path}: a key of {len(secret)} bytes is too short", hint)
    return secret


def _certificates(folder: Path, names: set[str]) -> Certificates | None:
    if names.isdisjoint(CERTIFICATES):
        return None
    for name in CERTIFICATES:
        if not os.access(folder / name, os.R_OK):
            raise TeamformerError(
                f"{folder / name} is absent or cannot be read",
                f"TLS needs all of {', '.join(CERTIFICATES)}",
            )
    return Certificates(*(folder / name for name in CERTIFICATES))


def _signers(folder: Path, names: set[str]) -> Path | None:
    """Return the folder if it has public keys; a private key without its public one is refused."""
    public = {name.removesuffix(PUBLIC) for name in names if name.endswith(PUBLIC)}
    private = {name.removesuffix(PRIVATE) for name in names if name.endswith(PRIVATE)}
    for name in sorted(private - public - {SHARED.removesuffix(PRIVATE)}):
        raise TeamformerError(
            f"{folder / name}{PRIVATE} is there without {name}{PUBLIC}",
            f"openssl pkey -in {name}{PRIVATE} -pubout -out {name}{PUBLIC}",
        )
    return folder if public else None


def _is_loopback(address: str) -> bool:
    host = address.rpartition(":")[0].strip("[]")
    try:
        return host == "localhost" or ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False
