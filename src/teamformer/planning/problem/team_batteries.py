"""Batteries and chargers of a situation in steps, for who times plans of teams exactly."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from teamformer.base.array_types import Floats
from teamformer.base.kernels.jit import kernel
from teamformer.mission.coordination import Known
from teamformer.mission.parts.charging import lengths
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.roads import GROUND


class TeamBatteries(NamedTuple):
    """What robots have to spend, in steps that each walks alone, and how far chargers are.

    Nobody has a battery where it has no robots. Ways are in cells; a robot without a battery
    `lasts` for no time.
    """

    lasts: Floats  # (robots,)
    left: Floats  # (robots,) once each is free
    filled: Floats  # (robots,) what a step of charging brings
    serving: Floats  # (robots,) what a step of serving takes
    waiting: Floats  # (robots,) what a step of waiting takes
    wanted: Floats  # (robots, tasks) what each has to have left there, to do it and charge then
    to: Floats  # (places + chargers, chargers) ways from places, then from chargers
    fro: Floats  # (chargers, tasks)


def no_team_batteries() -> TeamBatteries:
    """Return what stands for batteries where nobody has one."""
    one, two = np.zeros(0), np.zeros((0, 0))
    return TeamBatteries(one, one, one, one, one, two, two, two)


def team_batteries(
    known: Known, places: Sequence[Place], spots: Sequence[Place], speed: Floats
) -> TeamBatteries:
    """Return the batteries of the robots that are left, for open tasks, which are at `spots`.

    `speed` (robots,) is what each walks in a step, in the cells in which ways are told.
    """
    mission, robots = known.mission, known.robots
    charging = mission.charging
    if charging is None:
        return no_team_batteries()
    cell = mission.world.pace(mission.robots[robots[0]].speed) / float(speed[0])
    chargers = [charger.at for charger in mission.chargers]
    batteries = [mission.robots[robot].battery for robot in robots]
    has_one = [battery is not None for battery in batteries]
    filled = [one.lasts / one.fills if one and one.fills else one.lasts if one else 0.0
              for one in batteries]  # fmt: skip
    wanted = np.array([charging.wanted(robot) for robot in robots])[:, list(known.open_tasks)]
    world = mission.world
    return TeamBatteries(
        lasts=np.array([one.lasts if one else 0.0 for one in batteries]),
        left=np.where(has_one, [known.left[robot] for robot in robots], 0.0),
        filled=np.array(filled),
        serving=np.array([one.serving if one else 0.0 for one in batteries]),
        waiting=np.array([one.waiting if one else 0.0 for one in batteries]),
        wanted=wanted,
        to=np.array(lengths(world, GROUND, [*places, *chargers], chargers)) / cell,
        fro=np.array(lengths(world, GROUND, chargers, spots)) / cell,
    )


@kernel
def may_charge(batteries: TeamBatteries) -> bool:
    """Say whether anybody has a battery."""
    return len(batteries.lasts) > 0
