"""Vehicles that fail at what they are told, reject it or never show it."""

from __future__ import annotations

import shutil

import pytest

from teamformer.fleet.bodies.body import Command, Report
from teamformer.fleet.bodies.vda5050 import tries, watch
from teamformer.fleet.bodies.vda5050.tries import FAILURES, UNANSWERED
from vda5050_vehicle import Vehicle, driving, two_vehicles, wait_for

pytestmark = pytest.mark.skipif(shutil.which("mosquitto") is None, reason="needs mosquitto")

SERVE_ONE = Command(1, None, 1, 0, True)
BRING = Command(1, None, 0, 0, True, 2.0, 0.5)


@pytest.fixture(autouse=True)
def _impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tries, "AGAIN", 0.05)


def ids_of(vehicle: Vehicle, kind: str) -> list[str]:
    """Return the names under which a vehicle was told to act, each once, in order."""
    inner = [a for order in vehicle.orders for node in order["nodes"] for a in node["actions"]]
    told = [action for action in inner + vehicle.actions if action["actionType"] == kind]
    return list(dict.fromkeys(action["actionId"] for action in told))


def has_served(report: Report) -> bool:
    return report.has_served


def is_unfit(report: Report) -> bool:
    return report.is_unfit


@pytest.mark.parametrize("version", ["2.0.0", "2.1.0", "3.0.0"])
def test_a_service_that_fails_is_told_again_under_another_name(
    version: str, capfd: pytest.CaptureFixture[str]
) -> None:
    with driving(version, mission=two_vehicles()) as (body, vehicle):
        vehicle.fails["serve"] = FAILURES - 1
        body.command(SERVE_ONE)
        report = wait_for(body, vehicle, has_served)
    assert not report.is_unfit
    assert len(ids_of(vehicle, "serve")) == FAILURES
    line = "v1: the vehicle has failed to serve one and says 'jammed'; it gets the order again"
    assert capfd.readouterr().err.splitlines() == [line] * (FAILURES - 1)


def test_who_goes_on_failing_is_unfit_and_is_told_nothing_more(
    capfd: pytest.CaptureFixture[str],
) -> None:
    with driving("2.1.0", mission=two_vehicles()) as (body, vehicle):
        vehicle.fails["serve"] = 100
        body.command(SERVE_ONE)
        report = wait_for(body, vehicle, is_unfit)
        assert not report.has_served
        for _ in range(20):
            assert wait_for(body, vehicle, lambda report: True).is_unfit
    assert len(ids_of(vehicle, "serve")) == FAILURES
    last = capfd.readouterr().err.splitlines()[-1]
    assert last == "v1: the vehicle has failed to serve one and says 'jammed'; it is unfit for 30 s"


def test_an_action_that_the_vehicle_does_not_know_makes_it_unfit(
    capfd: pytest.CaptureFixture[str],
) -> None:
    with driving("2.0.0", mission=two_vehicles()) as (body, vehicle):
        vehicle.knows.remove("serve")
        body.command(SERVE_ONE)
        wait_for(body, vehicle, is_unfit)
    assert capfd.readouterr().err.splitlines() == [
        "v1: the vehicle says actionError: not supported",
        f"v1: the vehicle was told {UNANSWERED} times to serve one and shows nothing of it;"
        " it is unfit for 30 s",
    ]


def test_who_shows_at_last_what_it_was_told_is_fit(monkeypatch: pytest.MonkeyPatch) -> None:
    with driving("2.0.0", mission=two_vehicles()) as (body, vehicle):
        vehicle.rejects = "not in automatic mode"
        body.command(Command(1, (2.0, 3.0), 1))
        wait_for(body, vehicle, is_unfit)
        vehicle.rejects = ""
        report = wait_for(body, vehicle, lambda report: report.leg == 1)
    assert (report.x, report.y, report.is_unfit) == (2.0, 3.0, False)


def test_why_an_order_is_rejected_is_told_once(capfd: pytest.CaptureFixture[str]) -> None:
    with driving("3.0.0", mission=two_vehicles()) as (body, vehicle):
        vehicle.rejects = "not in automatic mode"
        body.command(Command(1, (2.0, 3.0), 1))
        wait_for(body, vehicle, lambda report: len(vehicle.orders) > 3)
        vehicle.rejects = ""
        wait_for(body, vehicle, lambda report: report.leg == 1)
        vehicle.rejects = "not in automatic mode"
        body.command(Command(2, (1.0, 1.0), 1))
        wait_for(body, vehicle, lambda report: len(vehicle.errors) > 1)
    line = "v1: the vehicle says orderError: not in automatic mode (nodeId start)"
    assert capfd.readouterr().err.splitlines() == [line, line]


@pytest.mark.parametrize("kind", ["pick", "drop"])
@pytest.mark.parametrize("version", ["2.1.0", "3.0.0"])
def test_a_load_that_it_failed_to_pick_or_to_drop_is_brought_all_the_same(
    version: str, kind: str, capfd: pytest.CaptureFixture[str]
) -> None:
    with driving(version) as (body, vehicle):
        vehicle.fails[kind] = FAILURES - 1
        if kind == "pick":
            vehicle.fails["drop"] = FAILURES - 1  # of a load that it has not
        body.command(BRING)
        report = wait_for(body, vehicle, has_served)
    assert (report.x, report.y, report.carries, report.is_unfit) == (9.0, 3.0, False, False)
    assert len(ids_of(vehicle, kind)) == FAILURES
    line = f"v1: the vehicle has failed to {kind} crate and says 'jammed'; it gets the order again"
    assert capfd.readouterr().err.splitlines() == [line] * (FAILURES - 1)


def test_a_load_that_it_goes_on_failing_to_pick_makes_it_unfit() -> None:
    with driving("2.1.0") as (body, vehicle):
        vehicle.fails["pick"] = 100
        body.command(BRING)
        report = wait_for(body, vehicle, is_unfit)
        assert (report.carries, report.has_served) == (False, False)
    assert len(ids_of(vehicle, "pick")) == FAILURES


def test_a_load_that_it_goes_on_failing_to_drop_is_set_down_where_it_can_be(
    capfd: pytest.CaptureFixture[str],
) -> None:
    """Its agent has it stop then, as it is unfit; it fails at that once more."""
    with driving("2.1.0") as (body, vehicle):
        vehicle.fails["drop"] = FAILURES + 1
        body.command(BRING)
        wait_for(body, vehicle, is_unfit)
        body.command(Command(2, None))
        wait_for(body, vehicle, lambda report: report.leg == 2)
    assert "failed to drop crate and says 'jammed'; it is unfit for 30 s" in capfd.readouterr().err
    *failed, last = ids_of(vehicle, "drop")
    assert len(failed) == FAILURES + 1
    assert "set-down" in failed[-1]
    assert "set-down" in last


def test_an_order_to_pick_that_is_never_shown_makes_it_unfit() -> None:
    with driving("2.1.0") as (body, vehicle):
        vehicle.rejects = "no such action"
        body.command(BRING)
        assert not wait_for(body, vehicle, is_unfit).carries


def test_who_is_silent_for_long_is_unfit(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    with driving("2.1.0", mission=two_vehicles()) as (body, vehicle):
        body.command(SERVE_ONE._replace(serve=False))
        last = wait_for(body, vehicle, lambda report: report.leg == 1)
        assert not last.is_unfit
        monkeypatch.setattr(watch, "AWAY", 0.0)
        report = body.report()
        assert report == last._replace(number=report.number, is_unfit=True)
        monkeypatch.undo()
        assert not wait_for(body, vehicle, lambda report: True).is_unfit
    told = capfd.readouterr().err.splitlines()
    assert told == ["v1: the vehicle has said nothing for 0 s", "v1: the vehicle is there again"]


def test_a_vehicle_on_another_map_gets_no_orders(capfd: pytest.CaptureFixture[str]) -> None:
    with driving("2.1.0", mission=two_vehicles()) as (body, vehicle):
        wait_for(body, vehicle, lambda report: True)
        vehicle.map = "attic"
        while body.report() is not None:
            vehicle.say()
        body.command(Command(1, (2.0, 3.0), 1))
        for _ in range(20):
            vehicle.say()
            assert body.report() is None
        assert vehicle.orders == []
        vehicle.map = "yard"
        wait_for(body, vehicle, lambda report: report.leg == 1)
    assert capfd.readouterr().err.splitlines() == [
        "v1: the vehicle is on map 'attic', not on 'yard', and gets no orders",
        "v1: the vehicle is there again",
    ]


def test_a_vehicle_that_is_off_line_is_told(capfd: pytest.CaptureFixture[str]) -> None:
    with driving("2.1.0", mission=two_vehicles()) as (body, vehicle):
        wait_for(body, vehicle, lambda report: True)
        vehicle.say_connection("CONNECTIONBROKEN")
        while body.report() is not None:
            pass
        wait_for(body, vehicle, lambda report: True)
    told = capfd.readouterr().err.splitlines()
    assert told == ["v1: the vehicle is off line", "v1: the vehicle is there again"]
