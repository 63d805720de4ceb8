"""The line to a vehicle: an MQTT broker, with a user, a password and TLS where it wants them."""

from __future__ import annotations

import json
import ssl
import threading
import time
from collections.abc import Callable, Mapping
from datetime import UTC, datetime
from typing import Any

from paho.mqtt import client as mqtt
from paho.mqtt.enums import CallbackAPIVersion
from paho.mqtt.reasoncodes import ReasonCode

from teamformer.base.errors import TeamformerError
from teamformer.fleet.bodies.vda5050.address import Address

KEEPALIVE = 15  # seconds

REFUSES = "refuses this end"

PATIENCE = 10.0
"""Seconds in which a broker has to answer who connects to it."""

LOGIN = "the address begins mqtt://USER:PASSWORD@HOST; is that the user, and may it connect?"
ENCRYPTED = "is it one of MQTT? one that wants TLS is named mqtts://"
CERTIFICATE = "does it want a certificate of this end? name it: ?certificate=FILE&key=FILE"
AUTHORITY = "name the file of the authority that signed its certificate: ?ca=FILE"

Take = Callable[[str, Mapping[str, Any]], None]
"""Takes what a vehicle said: the last part of the topic, and the message."""


class Broker:
    """Publishes to one vehicle and hears it. Goes on by itself if the broker comes back.

    Raises `TeamformerError` if there is no broker, or none that lets this end in.
    """

    def __init__(
        self, address: Address, name: str, take: Take, tell: Callable[[str], None]
    ) -> None:
        self._address, self._take, self._tell = address, take, tell
        self._headers: dict[str, int] = {}
        self._has_answered = threading.Event()
        self._is_closing = False
        self._fault = ""  # why this end is not connected
        self._client = mqtt.Client(CallbackAPIVersion.VERSION2, name)
        self._client.on_connect = self._on_connect
        self._client.on_disconnect = self._on_disconnect
        self._client.on_message = self._on_message
        if address.user is not None:
            self._client.username_pw_set(address.user, address.password)
        try:
            if address.is_encrypted:
                self._client.tls_set(address.ca, address.certificate, address.key)
            self._client.connect(address.host, address.port, KEEPALIVE)
        except (OSError, ValueError) as error:  # a ValueError: what is no name of a host
            hint = AUTHORITY if isinstance(error, ssl.SSLError) else "start it, or name another one"
            raise TeamformerError(f"no broker at {address.broker}: {error}", hint) from None
        self._client.loop_start()
        self._wait()

    def _wait(self) -> None:
        """Wait until the broker lets this end in."""
        if not self._has_answered.wait(PATIENCE):
            self._fault = "does not answer"
        if self._fault:
            self.close()
            hint = CERTIFICATE if self._address.is_encrypted else ENCRYPTED
            hint = LOGIN if self._fault.startswith(REFUSES) else hint
            raise TeamformerError(f"the broker at {self._address.broker} {self._fault}", hint)

    def publish(self, topic: str, content: Mapping[str, Any]) -> None:
        """Send a message under its header."""
        self._headers[topic] = self._headers.get(topic, -1) + 1
        stamp = datetime.now(UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z")
        header = {
            "headerId": self._headers[topic],
            "timestamp": stamp,
            "version": self._address.version,
            "manufacturer": self._address.manufacturer,
            "serialNumber": self._address.serial,
        }
        self._client.publish(self._address.topic(topic), json.dumps({**header, **content}))

    def close(self) -> None:
        """Leave the broker, once what was said is out."""
        self._is_closing = True
        if self._client.is_connected():
            time.sleep(0.2)
        self._client.disconnect()
        self._client.loop_stop()

    def _on_connect(
        self, client: mqtt.Client, _data: Any, _flags: Any, reason: ReasonCode, _: Any
    ) -> None:
        if reason.is_failure:
            self._note(f"{REFUSES}: {reason}")
            return
        for topic in ("state", "connection"):
            client.subscribe(self._address.topic(topic), qos=1)
        self._note("")

    def _on_disconnect(
        self, _client: mqtt.Client, _data: Any, _flags: Any, reason: ReasonCode, _: Any
    ) -> None:
        if not self._fault:
            self._note(f"has closed the connection: {reason}")

    def _note(self, fault: str) -> None:
        """Note why this end is not connected, or that it is; tell it where that is news."""
        if self._has_answered.is_set() and fault != self._fault and not self._is_closing:
            told = f"{fault}; it is tried again" if fault else "is there again"
            self._tell(f"the broker at {self._address.broker} {told}")
        self._fault = fault
        self._has_answered.set()

    def _on_message(self, _client: mqtt.Client, _data: Any, message: mqtt.MQTTMessage) -> None:
        """Hand on a state or a connection; what is no JSON object is left."""
        try:
            content = json.loads(message.payload)
        except (ValueError, RecursionError):
            return
        if isinstance(content, dict):
            self._take(message.topic.rpartition("/")[2], content)
