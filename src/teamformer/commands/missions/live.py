"""`teamformer live`: a mission in the browser while it runs."""

from __future__ import annotations

import contextlib
import secrets
import socket
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from teamformer.commands.compiling import announce_compiling
from teamformer.commands.console import prepare_folder, say
from teamformer.commands.missions.run import ready_policy
from teamformer.commands.robots.rehearse import require_extra, signatures_in
from teamformer.errors import TeamformerError
from teamformer.mission.rules import rules_of_live_missions, rules_of_simulated_missions
from teamformer.model import Scenario
from teamformer.policies.protocol import Policy
from teamformer.scenarios.files import read_scenario

if TYPE_CHECKING:
    from teamformer.fleet.observer.session import ObserverSession
    from teamformer.live.session import Session
    from teamformer.live.workshop import Workshop

LOOPBACK = ("127.0.0.1", "localhost", "::1")


@dataclass(frozen=True)
class FleetAt:
    """Where a running fleet is heard: the endpoint of one of its agents."""

    endpoint: str
    pace: float
    key: Path | None
    tls: Path | None
    sign: Path | None


@dataclass(frozen=True)
class Options:
    """What the command line says of a live mission."""

    policy: str
    seed: int
    port: int
    host: str
    speed: float
    time_limit: float
    folder: Path
    fleet: FleetAt | None = None


def live(path: Path | None, options: Options) -> int:
    """Serve a mission, or without one the editor, until Ctrl-C; return the exit status.

    What was done by then is saved.
    """
    try:
        import teamformer.live.server  # noqa: F401
    except ImportError as error:
        raise TeamformerError(
            f"live needs starlette, uvicorn and websockets ({error})",
            "pip install 'teamformer[live]'",
        ) from None
    prepare_folder(options.folder)
    _check_port(options.host, options.port)
    if options.fleet is None:
        session, name = _prepare(path, options)
        _serve(session, name, options)
        return 0
    with contextlib.closing(_observe(path, options.fleet, options.folder)) as onlooker:
        _serve(onlooker, "fleet", options)
    return 0


def _serve(session: Session | Workshop | ObserverSession, name: str, options: Options) -> None:
    """Serve a mission's page until Ctrl-C, and save."""
    from teamformer.live.server import Doors, make_app, serve
    from teamformer.viewer.html import live_page

    token = None if options.host in LOOPBACK else secrets.token_urlsafe(16)
    doors = Doors(_names(options.host, options.port), token)
    address = f"http://{_bracketed(options.host)}:{options.port}/"
    if token is not None:
        address += f"?token={token}"

    def tell() -> None:
        say(f"live: {address}")
        say("Ctrl-C ends it and saves what was done")

    def save() -> None:
        for saved in session.save():
            say(f"saved: {saved}")
        if session.note:
            say(f"note: {session.note}")

    app = make_app(session, lambda: live_page(name), doors, save)
    with contextlib.suppress(KeyboardInterrupt):
        serve(app, options.host, options.port, tell)


def _prepare(path: Path | None, options: Options) -> tuple[Session | Workshop, str]:
    """Return the session of a mission, or the editor; what is wrong is refused at once."""
    from teamformer.live.mission import Mission
    from teamformer.live.session import Session
    from teamformer.live.workshop import Workshop

    scenario = None if path is None else read_scenario(path, rules_of_live_missions)
    ready_policy(options.policy, options.time_limit)
    has_plan = scenario is not None and scenario.allocation == "plan"
    announce_compiling([options.policy], scenario is None or scenario.is_planned, has_plan)

    def start(scenario: Scenario) -> Mission:
        def make() -> Policy:
            return ready_policy(options.policy, options.time_limit)

        return Mission(scenario, make, options.policy, options.seed)

    if scenario is None:
        return Workshop(start, options.folder, options.speed), "editor"
    return Session(start(scenario), options.folder, options.speed), scenario.name


def _observe(path: Path | None, fleet: FleetAt, folder: Path) -> ObserverSession:
    """Return the session of a running fleet."""
    require_extra("zenoh")
    from teamformer.fleet.messages import OPERATOR, Post
    from teamformer.fleet.mission import Mission, seconds_a_step
    from teamformer.fleet.observer.session import ObserverSession
    from teamformer.fleet.observer.watch import Watch
    from teamformer.fleet.transports.transport import (
        check_endpoints,
        read_certificates,
        read_secret,
    )
    from teamformer.fleet.transports.zenoh_mesh import ZenohTransport

    if path is None:
        raise TeamformerError("which mission is the fleet on?", "name its scenario file")
    scenario = read_scenario(path, rules_of_simulated_missions)
    mission = Mission(scenario, seconds_a_step(scenario, fleet.pace))
    secret, certificates = read_secret(fleet.key), read_certificates(fleet.tls)
    check_endpoints([fleet.endpoint], secret, certificates)
    signatures = signatures_in(fleet.sign, mission, OPERATOR)
    post = Post(mission.number, mission.robots, secret, signatures)
    transport = ZenohTransport(  # last: a process ends only once it is closed
        mission.number, OPERATOR, None, [fleet.endpoint], certificates=certificates
    )
    return ObserverSession(Watch(mission), transport, post, folder, say)


def _names(host: str, port: int) -> frozenset[str]:
    hosts = LOOPBACK if host in LOOPBACK else (host,)
    return frozenset(f"{_bracketed(name)}:{port}".lower() for name in hosts)


def _bracketed(host: str) -> str:
    return f"[{host}]" if ":" in host else host


def _check_port(host: str, port: int) -> None:
    """Make sure that the port is free; suggest one that is."""
    with socket.socket(socket.AF_INET6 if ":" in host else socket.AF_INET) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((host, port))
        except OSError as error:
            reason = error.strerror or str(error)
            raise TeamformerError(
                f"{host}:{port} cannot be used: {reason}", f"try --port {_free_port(host)}"
            ) from None


def _free_port(host: str) -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])
