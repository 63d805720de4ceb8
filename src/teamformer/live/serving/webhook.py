"""Alerts sent on: a POST of a JSON object to an address for each that is raised or has ended."""

from __future__ import annotations

import json
import queue
import threading
import time
import urllib.error
import urllib.request
from collections.abc import Callable, Sequence
from datetime import UTC, datetime
from http.client import HTTPException
from typing import Any
from urllib.parse import urlsplit

from teamformer.base.errors import TeamformerError
from teamformer.live.running.alerts import Alert

TIMEOUT = 10.0
"""Seconds that one try may take."""

PAUSES = (1.0, 5.0, 30.0)
"""Seconds before each further try of what was not taken."""

LAST = 3.0
"""Seconds that what is not sent yet may take when all ends."""


class Webhook:
    """Sends alerts one after another from a thread of its own, so that nobody waits for them.

    `say` tells the person who started it, once, if what is at the address takes nothing.
    """

    def __init__(
        self,
        url: str,
        mission: str,
        say: Callable[[str], None] = lambda _: None,
        pauses: Sequence[float] = PAUSES,
    ) -> None:
        self._url, self._host = url, _host_of(url)
        self._mission, self._say, self._pauses = mission, say, pauses
        self._events: queue.SimpleQueue[dict[str, Any] | None] = queue.SimpleQueue()
        self._is_over = threading.Event()
        self._has_complained = False
        self._thread = threading.Thread(target=self._send_all, daemon=True)
        self._thread.start()

    def tell(self, new: Sequence[Alert], past: Sequence[Alert]) -> None:
        """Send alerts that are new, and those that hold no more; a return is the end of a loss."""
        for event, alerts in (("ended", past), ("raised", new)):
            for alert in alerts:
                if not alert.is_return:
                    self._events.put(event_of(event, self._mission, alert))

    def close(self) -> None:
        """Send what is left, for a moment; then no more."""
        self._events.put(None)
        self._thread.join(LAST)
        self._is_over.set()

    def _send_all(self) -> None:
        while (event := self._events.get()) is not None:
            self._send(event)

    def _send(self, event: dict[str, Any]) -> None:
        for pause in (0.0, *self._pauses):
            if self._is_over.wait(pause):
                return
            refusal = _post(self._url, event)
            if refusal is None:
                self._has_complained = False
                return
        if not self._has_complained:
            self._say(f"alerts are not taken by {self._host}: {refusal}")
        self._has_complained = True


def event_of(event: str, mission: str, alert: Alert) -> dict[str, Any]:
    """Return what is sent of an alert that is `raised` or has `ended`.

    `text` is the whole in a sentence, as chats show it. `at` is now, in UTC; for so many `seconds`
    it has been so.
    """
    seconds = 0.0 if alert.since is None else max(0.0, time.monotonic() - alert.since)
    now = datetime.now(UTC).replace(microsecond=0)
    said = alert.text() if event == "raised" else f"no longer: {alert.what}"
    return {
        "event": event,
        "mission": mission,
        "text": f"{mission}: {said}",
        "alert": {"key": alert.key, "what": alert.what, "why": alert.why, "do": alert.do},
        "at": now.isoformat(),
        "seconds": round(seconds, 1),
    }


def _host_of(url: str) -> str:
    """Return the host of an address; TeamformerError if nothing can be posted there."""
    try:
        parts = urlsplit(url)
    except ValueError:  # a bracket that is not closed
        parts = urlsplit("")
    if parts.scheme not in ("http", "https") or not parts.hostname:
        hint = "write it whole, such as https://chat.example.org/hooks/abc"
        raise TeamformerError(f"--webhook {url}: this is no address of the web", hint)
    return parts.hostname


def _post(url: str, event: dict[str, Any]) -> str | None:
    """Send an event; return why it was not taken, or None."""
    data = json.dumps(event).encode()
    headers = {"Content-Type": "application/json", "User-Agent": "teamformer"}
    try:
        with urllib.request.urlopen(urllib.request.Request(url, data, headers), timeout=TIMEOUT):
            return None
    except urllib.error.HTTPError as error:
        error.close()
        return f"it answers {error.code} {error.reason}"
    except OSError as error:  # nobody there, a name that is unknown, a certificate
        return str(getattr(error, "reason", error))
    except (ValueError, HTTPException) as error:  # what answers does not speak HTTP
        return str(error) or type(error).__name__
