"""What comes from outside to the page and its server: records that nobody made, and any headers."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import pytest
from hypothesis import strategies as st

from browsers import Opened
from forgeries import edited_records
from methods import METHODS, play
from missions import SEEDS, missions
from teamformer.base.errors import TeamformerError
from teamformer.files.mission_files import mission_from_tree
from teamformer.record.files.reading import record_from_tree
from teamformer.record.files.writing import record_to_tree
from teamformer.viewer.html import record_page
from watching import fuzzed, noted

doors = pytest.importorskip("teamformer.live.serving.doors", reason="the extra `live` is absent")
requests = pytest.importorskip("starlette.requests")

MOST_SHOWN = 12
"""Steps of a record that are looked at."""


@pytest.fixture(scope="module")
def opened(browser: Any) -> Any:
    """A page that notes what nobody catches in it."""
    page = Opened(browser.new_page())
    page.page.on("pageerror", lambda error: page.errors.append(str(error)))
    yield page
    page.page.close()


@fuzzed(
    8,
    "run FILE --method {method} --seed {seed} --out O; then change O/record.json as below",
    mission=missions(),
    method=METHODS,
    seed=SEEDS,
    data=st.data(),
)
def test_whatever_a_record_holds_the_drawing_goes_on(
    opened: Opened,
    tmp_path_factory: pytest.TempPathFactory,
    mission: Any,
    method: str,
    seed: int,
    data: st.DataObject,
) -> None:
    """Teams, loads and all else may be where they cannot be; a record only has to be readable."""
    record = record_to_tree(play(mission_from_tree(mission), method, seed).record)
    del record["told"]  # of other steps `view` makes no page
    noted["changed"] = changed = data.draw(edited_records(copy.deepcopy(record)))
    try:
        changed = record_to_tree(record_from_tree(changed, "record"))
    except TeamformerError:
        return  # `view` makes no page of it
    file = Path(tmp_path_factory.mktemp("page"), "page.html")
    file.write_text(record_page(changed), encoding="utf-8")
    opened.errors.clear()
    opened.page.goto(file.as_uri())
    opened.shown_step()
    for step in range(1, min(MOST_SHOWN, len(changed["steps"])) + 1):
        drawn = opened.page.evaluate("window.teamformer.framesDrawn()")
        opened.page.keyboard.press("ArrowRight")
        opened.wait_until(f"window.teamformer.framesDrawn() > {drawn}", seconds=10.0)
        assert opened.shown_step() == step
    assert opened.errors == []


NAMES = ("localhost", "127.0.0.1", "teams.example.org", "evil.example", "[::1]", "a", "")
PORTS = ("", ":8765", ":80", ":", ":x")
SCHEMES = ("http://", "https://", "HTTP://", "null", "", "ftp://", "http://[")
HOSTS = st.one_of(
    st.builds(str.__add__, st.sampled_from(NAMES), st.sampled_from(PORTS)),
    st.text(st.characters(max_codepoint=255), max_size=12),
)
ORIGINS = st.one_of(st.none(), st.builds(str.__add__, st.sampled_from(SCHEMES), HOSTS))


@fuzzed(
    200,
    "live FILE; then ask for it with these headers",
    hosts=st.sampled_from([None, ("localhost", "127.0.0.1")]),
    further=st.sampled_from([(), ("teams.example.org",)]),
    token=st.sampled_from([None, "t0ken", "é"]),
    host=HOSTS,
    origin=ORIGINS,
    given=st.sampled_from(["", "t0ken", "é", "%C3%A9", "\x00"]),
)
def test_only_who_should_be_let_in_is(
    hosts: Any, further: Any, token: Any, host: str, origin: str | None, given: str
) -> None:
    """Whatever headers a browser or anybody else sends: no exception, and no way past the doors."""
    at = None if hosts is None else frozenset(hosts)
    asked = doors.Doors(at, token, frozenset(further))
    headers = [(b"host", host.encode("latin-1"))]
    headers += [] if origin is None else [(b"origin", origin.encode("latin-1", "replace"))]
    scope = {"type": "http", "headers": headers, "query_string": f"token={given}".encode()}
    is_let_in = asked.refusal(requests.HTTPConnection(scope)) is None
    if not is_let_in:
        return
    assert token is None or given in (token, "%C3%A9")
    known = (*(hosts or ()), *further)
    assert hosts is None or host.lower().startswith(known)
    assert origin is None or host.lower() in origin.lower() or any(n in origin for n in further)
