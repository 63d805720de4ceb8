"""`teamformer live`: a mission in the browser while it runs."""

from __future__ import annotations

import contextlib
import secrets
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from teamformer.commands.addresses import Address, check_address
from teamformer.commands.compiling import compile_ahead
from teamformer.commands.console import prepare_folder, say
from teamformer.commands.missions.run import chosen_method
from teamformer.extras import require
from teamformer.mission.rules import rules_not_played
from teamformer.model import Scenario
from teamformer.scenarios.files import read_scenario
from teamformer.scenarios.smallest import smallest_scenario
from teamformer.trials.methods import load_method

if TYPE_CHECKING:
    from teamformer.fleet.observer.session import ObserverSession
    from teamformer.live.workshop import Workshop

SPEED = 4.0
"""Steps a second at first; the page changes it."""

TIME_LIMIT = 10.0
"""Seconds that a method may plan."""


@dataclass(frozen=True)
class Options:
    """What the command line says of a live mission."""

    method: str | None
    seed: int
    address: Address
    folder: Path


def live(path: Path | None, options: Options) -> int:
    """Serve a mission, or without one the editor, until Ctrl-C; return the exit status.

    What was done by then is saved.
    """
    require("live")
    prepare_folder(options.folder)
    check_address(options.address)
    session, name = _prepare(path, options)
    serve_page(session, name, options.address)
    return 0


def serve_page(session: Workshop | ObserverSession, name: str, at: Address) -> None:
    """Serve a mission's page until Ctrl-C, and save."""
    from teamformer.live.doors import Doors
    from teamformer.live.server import make_app, serve
    from teamformer.viewer.html import live_page

    token = None if at.is_here_only else secrets.token_urlsafe(16)
    doors = Doors(at.names, token, frozenset(at.further))
    ending = "" if token is None else f"?token={token}"

    def tell() -> None:
        for address in at.to_open():
            say(f"live: {address}{ending}")
        if at.further:
            say(f"live: as {', '.join(at.further)} with /{ending} at the end")
        say("Ctrl-C ends it and saves what was done")

    def save() -> None:
        for saved in session.save():
            say(f"saved: {saved}")
        if session.note:
            say(f"note: {session.note}")

    app = make_app(session, lambda: live_page(name), doors, save)
    with contextlib.suppress(KeyboardInterrupt):
        serve(app, at.host, at.port, tell)


def _prepare(path: Path | None, options: Options) -> tuple[Workshop, str]:
    """Return what draws and runs missions; what is wrong with the file is refused at once."""
    from teamformer.live.drafts import draft_of_file
    from teamformer.live.mission_with_past import Mission
    from teamformer.live.workshop import Draft, Workshop

    scenario = None if path is None else read_scenario(path, rules_not_played)
    name = options.method
    chosen = chosen_method(name, scenario or smallest_scenario(), TIME_LIMIT)
    compile_ahead([chosen], scenario)

    def start(mission: Scenario) -> Mission:
        chosen = chosen_method(name, mission, TIME_LIMIT).name
        return Mission(mission, lambda: load_method(chosen, TIME_LIMIT), options.seed)

    if path is None or scenario is None:
        return Workshop(start, options.folder, SPEED, say=say), "editor"
    text = path.read_text(encoding="utf-8") if path.suffix.lower() != ".json" else ""
    draft = Draft(draft_of_file(path, path.stem), path.name, text)
    return Workshop(start, options.folder, SPEED, draft, scenario, say), scenario.name
