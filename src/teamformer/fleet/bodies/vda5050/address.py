"""What `--body vda5050:...` names: a broker and how to log in there, a vehicle, its map."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from urllib.parse import SplitResult, parse_qsl, unquote, urlsplit

from teamformer.base.errors import TeamformerError
from teamformer.fleet.bodies.vda5050.dialect import DIALECTS, VERSIONS, Dialect

HINT = "write vda5050:mqtt://USER:PASSWORD@HOST:PORT/INTERFACE/MANUFACTURER/SERIAL?map=ID"
PORTS = {"mqtt": 1883, "mqtts": 8883}
FILES = ("ca", "certificate", "key")
KEYS = ("map", "version", "layout", *FILES)


@dataclass(frozen=True)
class Address:
    """A vehicle at a broker.

    With TLS, `ca` names the file of the authority that signed the broker's certificate, if that is
    none of the system's; `certificate` and `key` name those of this end, if the broker asks.
    `layout` names a file in the Layout Interchange Format with the nodes and edges of roads.
    """

    host: str
    port: int
    interface: str
    manufacturer: str
    serial: str
    user: str | None = None
    password: str | None = field(default=None, repr=False)
    is_encrypted: bool = False
    map: str = "map"
    version: str = VERSIONS[0]
    ca: str | None = None
    certificate: str | None = None
    key: str | None = None
    layout: str | None = None

    @property
    def broker(self) -> str:
        """Return the broker as messages name it."""
        return f"{self.host}:{self.port}"

    @property
    def major(self) -> str:
        """Return the first number of the version."""
        return self.version.partition(".")[0]

    @property
    def dialect(self) -> Dialect:
        """Return the words of the vehicle's version."""
        return DIALECTS[self.major]

    def topic(self, name: str) -> str:
        """Return a topic's full name."""
        return f"{self.interface}/v{self.major}/{self.manufacturer}/{self.serial}/{name}"


def read_address(url: str) -> Address:
    """Return what `mqtt://USER:PASSWORD@HOST:PORT/INTERFACE/MANUFACTURER/SERIAL?key=...` names.

    With `mqtts` the connection is encrypted. In the user and the password, `%40` stands for `@`.
    Raises `TeamformerError` for anything else; no message shows the password.
    """
    shown = re.sub("//.*@", "//...@", url)
    try:
        parts = urlsplit(url)
        port = parts.port
    except ValueError:
        parts, port = SplitResult("", "", "", "", ""), None
    vehicle = [part for part in parts.path.split("/") if part]
    if parts.scheme not in PORTS or not parts.hostname or len(vehicle) != 3:
        raise TeamformerError(f"--body vda5050:{shown} is no address of a vehicle", HINT)
    user, password = parts.username, parts.password
    words: dict[str, Any] = {
        "user": None if user is None else unquote(user),
        "password": None if password is None else unquote(password),
        "is_encrypted": parts.scheme == "mqtts",
    }
    for key, value in parse_qsl(parts.query, keep_blank_values=True):
        if key not in KEYS:
            raise TeamformerError(f"--body vda5050 has no key '{key}'", f"use {', '.join(KEYS)}")
        words[key] = value
    port = PORTS[parts.scheme] if port is None else port
    return _checked(Address(parts.hostname, port, vehicle[0], vehicle[1], vehicle[2], **words))


def _checked(address: Address) -> Address:
    if address.version not in VERSIONS:
        raise TeamformerError(
            f"version of --body vda5050 is '{address.version}'", f"use {', '.join(VERSIONS)}"
        )
    named = {key: file for key in FILES if (file := getattr(address, key)) is not None}
    if named and not address.is_encrypted:
        raise TeamformerError(
            f"--body vda5050 names {', '.join(named)}, but mqtt:// is not encrypted",
            "write mqtts://",
        )
    if address.key is not None and address.certificate is None:
        raise TeamformerError("--body vda5050 names a key without its certificate", "name both")
    for key, file in named.items():
        if not Path(file).is_file():
            raise TeamformerError(
                f"--body vda5050: there is no file '{file}'", f"{key} names a file in PEM format"
            )
    return address
