"""VDA5050 vehicles charge: told so over a real broker, in the words of each version."""

from __future__ import annotations

import shutil

import pytest

from teamformer.fleet.bodies.body import Command, Report
from teamformer.fleet.bodies.vda5050.body import Vda5050Body
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.charging import Battery, Charger
from teamformer.mission.parts.plane import Plane
from test_vda5050 import wrong_with
from vda5050_vehicle import Vehicle, driving, wait_for

pytestmark = pytest.mark.skipif(shutil.which("mosquitto") is None, reason="needs mosquitto")

CHARGER = (1.0, 1.0)


def one_battery() -> FleetMission:
    """Return a vehicle that stands at a charger, with a task elsewhere."""
    robot = Robot("v1", CHARGER, {"lift": 1}, 2.0, battery=Battery(100, 50))
    task = Task("one", (2.0, 3.0), {"lift": 1}, 1)
    given = Mission(
        "yard",
        Plane(20.0, 20.0),
        ("lift",),
        (robot,),
        (task,),
        time="continuous",
        chargers=(Charger(CHARGER),),
    )
    return FleetMission(given)


def charging_of(vehicle: Vehicle) -> list[str]:
    """Return what the vehicle was told of charging, in order."""
    kinds = [action["actionType"] for action in vehicle.actions]
    return [kind for kind in kinds if "Charging" in kind]


def until(body: Vda5050Body, vehicle: Vehicle, *told: str) -> Report:
    """Let the vehicle say its state until it was told this of charging."""
    return wait_for(body, vehicle, lambda _: charging_of(vehicle) == [*told])


@pytest.mark.parametrize("version", ["2.0.0", "2.1.0", "3.0.0"])
def test_a_vehicle_is_told_to_charge_and_to_stop(version: str) -> None:
    """It drives there first; how full it is comes back with its state."""
    with driving(version, mission=one_battery()) as (body, vehicle):
        body.command(Command(7, (5.0, 1.0), charge=True))
        report = until(body, vehicle, "startCharging")
        assert (report.x, report.y, report.charge) == (5.0, 1.0, 0.8)
        assert vehicle.is_charging
        for name, content in vehicle.told.items():
            assert version == "2.0.0" or wrong_with(version, name, content) == []
        vehicle.charge = 99.0
        assert wait_for(body, vehicle, lambda report: report.charge == 1.0).leg == 7
        body.command(Command(7, (5.0, 1.0)))
        until(body, vehicle, "startCharging", "stopCharging")
        assert not vehicle.is_charging


def test_a_vehicle_that_fails_to_begin_is_told_again() -> None:
    with driving("2.1.0", mission=one_battery()) as (body, vehicle):
        vehicle.fails["startCharging"] = 1
        body.command(Command(7, CHARGER, charge=True))
        until(body, vehicle, "startCharging", "startCharging")
        assert vehicle.is_charging
        first, second = (action["actionId"] for action in vehicle.actions)
        assert first != second


def test_a_vehicle_that_charges_no_more_is_told_again_unless_it_is_full() -> None:
    with driving("3.0.0", mission=one_battery()) as (body, vehicle):
        body.command(Command(7, CHARGER, charge=True))
        wait_for(body, vehicle, lambda _: vehicle.is_charging)
        wait_for(body, vehicle, lambda _: bool(body._is_charging))
        vehicle.is_charging = False
        until(body, vehicle, "startCharging", "startCharging")
        vehicle.charge = 100.0
        wait_for(body, vehicle, lambda report: report.charge == 1.0)
        vehicle.is_charging = False
        for _ in range(3):
            wait_for(body, vehicle, lambda report: report.charge == 1.0)
        assert charging_of(vehicle) == ["startCharging", "startCharging"]
