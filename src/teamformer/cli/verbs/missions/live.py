"""`teamformer live`: a mission in the browser while it runs."""

from __future__ import annotations

import contextlib
import secrets
import shlex
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from teamformer.base.errors import TeamformerError
from teamformer.base.extras import require
from teamformer.cli.terminal.addresses import HostAndPort, check_address
from teamformer.cli.terminal.compiling import compile_ahead
from teamformer.cli.terminal.console import prepare_folder, say
from teamformer.cli.verbs.missions.run import chosen_method
from teamformer.files.drawn.smallest import smallest_mission
from teamformer.files.mission_files import read_mission
from teamformer.methods.by_name import load_method
from teamformer.mission.checks.rules import rules_not_run
from teamformer.mission.coordination import Plan
from teamformer.mission.model import Mission

if TYPE_CHECKING:
    from teamformer.fleet.observer.session import ObserverSession
    from teamformer.live.keeping.resuming import StartMission
    from teamformer.live.running.alarm import OnAlerts
    from teamformer.live.running.live_mission import LiveMission
    from teamformer.live.workshop import Workshop

SPEED = 4.0
"""Steps a second at first; the page changes it. In continuous time it depends on the mission."""

TIME_LIMIT = 10.0
"""Seconds that a method may plan."""


@dataclass(frozen=True)
class LiveOptions:
    """What the command line says of a live mission; `resumes` one that was cut off.

    `webhook` is an address to send alerts to.
    """

    method: str | None
    seed: int
    address: HostAndPort
    folder: Path
    resumes: bool = False
    webhook: str = ""


def live(path: Path | None, options: LiveOptions) -> int:
    """Serve a mission, or without one the editor, until Ctrl-C; return the exit status.

    What was done by then is saved.
    """
    require("live")
    prepare_folder(options.folder)
    check_address(options.address)
    with sending_alerts(options.webhook, "a live mission" if path is None else path.stem) as tell:
        if options.resumes:
            session, name = _prepare_to_go_on(path, options, tell)
        else:
            session, name = _prepare(path, options, tell)
            _put_aside(options.folder)
        serve_page(session, name, options.address)
    return 0


@contextlib.contextmanager
def sending_alerts(url: str, mission: str) -> Iterator[OnAlerts]:
    """Give what sends alerts to an address while the block runs; without one, what does nothing."""
    from teamformer.live.serving.webhook import Webhook

    if not url:
        yield lambda new, past: None
        return
    with contextlib.closing(Webhook(url, mission, say)) as webhook:
        yield webhook.tell


def serve_page(session: Workshop | ObserverSession, name: str, at: HostAndPort) -> None:
    """Serve a mission's page until Ctrl-C, and save."""
    from teamformer.live.serving.doors import Doors
    from teamformer.live.serving.server import make_app, serve
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


def _put_aside(folder: Path) -> None:
    """Keep the autosave of a mission that was cut off, and say how to go on with it."""
    from teamformer.live.keeping.resuming import put_aside

    kept = put_aside(folder)
    if kept is not None:
        say("note: a mission was cut off before it was saved; to go on with it:")
        say(f"note: teamformer live {shlex.quote(str(kept))} --resume")


def _prepare_to_go_on(
    path: Path | None, options: LiveOptions, on_alerts: OnAlerts
) -> tuple[Workshop, str]:
    """Return what goes on with a mission that was cut off: that of a file, or the latest one."""
    from teamformer.live.keeping.resuming import drop_half_line, find_autosave, read_autosave
    from teamformer.live.workshop import Workshop

    if options.method is not None or options.seed != 0:
        raise TeamformerError(
            "a mission goes on by the method and the seed that it began with",
            "leave out --method and --seed",
        )
    kept = read_autosave(path or find_autosave(options.folder))
    drop_half_line(kept)
    chosen = chosen_method(kept.method, kept.mission, TIME_LIMIT)
    compile_ahead([chosen], kept.mission)
    say(f"goes on: {kept.text()}")
    start = _starting(kept.method, kept.seed)
    workshop = Workshop(start, options.folder, SPEED, say=say, kept=kept, on_alerts=on_alerts)
    return workshop, kept.mission.name


def _starting(method: str | None, seed: int) -> StartMission:
    """Return what makes missions: by a method, or by the one that suits each if none is named."""
    from teamformer.live.continuous.running_course import RunningCourse
    from teamformer.live.steps.mission_with_past import RunningMission

    def start(mission: Mission, plans: Sequence[tuple[float, Plan]] = ()) -> LiveMission:
        chosen = chosen_method(method, mission, TIME_LIMIT).name
        running = RunningCourse if mission.time == "continuous" else RunningMission
        return running(mission, lambda: load_method(chosen, TIME_LIMIT), seed, plans)

    return start


def _prepare(path: Path | None, options: LiveOptions, on_alerts: OnAlerts) -> tuple[Workshop, str]:
    """Return what draws and runs missions; what is wrong with the file is refused at once."""
    from teamformer.live.drawing.drafts import Draft, draft_of_file
    from teamformer.live.workshop import Workshop

    mission = None if path is None else read_mission(path, rules_not_run)
    chosen = chosen_method(options.method, mission or smallest_mission(), TIME_LIMIT)
    compile_ahead([chosen], mission)
    start = _starting(options.method, options.seed)
    if path is None or mission is None:
        return Workshop(start, options.folder, SPEED, say=say, on_alerts=on_alerts), "editor"
    text = path.read_text(encoding="utf-8") if path.suffix.lower() != ".json" else ""
    draft = Draft(draft_of_file(path, path.stem), path.name, text)
    workshop = Workshop(start, options.folder, SPEED, draft, mission, say=say, on_alerts=on_alerts)
    return workshop, mission.name
