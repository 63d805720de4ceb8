"""Where each robot goes: its slot at the team's task, its partner, or out of the way."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from teamformer.base.array_types import Array
from teamformer.robotarium.control.assignment import match
from teamformer.robotarium.control.detours import way_point
from teamformer.robotarium.control.ring_slots import SPACING, fits, ring_radius, slots_around
from teamformer.robotarium.control.teams import RobotTeam
from teamformer.robotarium.robots.arena import HEIGHT, WIDTH

CLEARANCE = 0.30  # metres outside a ring where robots that it does not need keep

LATTICE = 0.1  # metres between the places where robots can keep out of the way

GIVES_UP, FARTHER = 10, 0.3
"""After so many decisions on the way to such a place a robot looks for one so much farther off."""


@dataclass(frozen=True)
class Work:
    """The tasks and who can do them, for the robots of one mission."""

    places: Array  # (tasks, 2) in the arena's coordinates
    needs: Array  # (tasks, caps)
    brings: Array  # (robots, caps)


@dataclass(frozen=True)
class Goals:
    """Where the robots are to go, and who of them has a slot around the team's task.

    Robots that keep clear are on their way to where they are in nobody's way; those that are idle
    are there, and give way to others.
    """

    places: Array  # (robots, 2)
    way_points: Array  # (robots, 2) what to head for now, on the way there
    has_slot: Array  # (robots,)
    keeps_clear: Array  # (robots,)
    is_idle: Array  # (robots,)


def choose_goals(
    teams: Sequence[RobotTeam], robots: Array, work: Work, is_open: Array, under_way: Array
) -> Goals:
    """Return the goals of robots (robots, 2).

    `is_open` (tasks,) are known and not done. `under_way` (robots,) counts the decisions since a
    robot with nothing to do set out for a place where it is in nobody's way.
    """
    has_slot, keeps_clear, is_idle = np.zeros((3, len(robots)), dtype=np.bool_)
    goals = Goals(robots.copy(), robots.copy(), has_slot, keeps_clear, is_idle)
    for task in {team.task for team in teams if team.task is not None}:
        heading = [team for team in teams if team.task == task and team.partner is None]
        chosen = choose_needed(heading, robots, work, task)
        if chosen:
            slots = slots_around(work.places[task], len(chosen))
            goals.places[chosen] = match(robots[chosen], slots)
            goals.has_slot[chosen] = True
    for team in teams:
        if team.partner is not None:
            partner = next(other for other in teams if other.slot == team.partner)
            goals.places[list(team.robots)] = robots[list(partner.robots)].mean(axis=0)
    free = [r for team in teams if team.partner is None for r in team.robots]
    radii = np.array([ring_radius(count) + CLEARANCE for count in work.needs.sum(axis=1)])
    free = [robot for robot in free if not goals.has_slot[robot]]
    farther = FARTHER * (under_way // GIVES_UP)  # (robots,) metres
    _keep_clear(free, goals.places, farther, work.places[is_open], radii[is_open])
    goals.is_idle[free] = (goals.places[free] == robots[free]).all(axis=1)
    goals.keeps_clear[free] = ~goals.is_idle[free]
    _lead_around_rings(goals, robots, work, [team.task for team in teams])
    return goals


def _lead_around_rings(
    goals: Goals, robots: Array, work: Work, tasks: Sequence[int | None]
) -> None:
    """Write the way points, around the rings of all tasks that somebody heads for."""
    rings = sorted({task for task in tasks if task is not None})
    radii = np.array([ring_radius(int(count)) for count in work.needs[rings].sum(axis=1)])
    for robot, at in enumerate(robots):
        goal = goals.places[robot]
        goals.way_points[robot] = way_point(at, goal, work.places[rings], radii)


def choose_needed(teams: Sequence[RobotTeam], robots: Array, work: Work, task: int) -> list[int]:
    """Return the robots of teams heading for a task that it needs, no more than these.

    First those of the team that covers most of it, the nearest of equals; then of the other
    teams, near ones first, who brings what is still missing.
    """
    away = np.linalg.norm(robots - work.places[task], axis=1)  # (robots,)
    needs = work.needs[task].astype(np.int64)

    def by_cover(team: RobotTeam) -> tuple[float, float]:
        has = work.brings[list(team.robots)].sum(axis=0)
        return -float(np.minimum(has, needs).sum()), float(away[list(team.robots)].min())

    missing, chosen = needs.copy(), list[int]()
    for team in sorted(teams, key=by_cover):
        for robot in sorted(team.robots, key=lambda r: float(away[r])):
            if (np.minimum(work.brings[robot], missing) > 0).any():
                chosen.append(robot)
                missing -= np.minimum(work.brings[robot], missing)
    return chosen


def _keep_clear(
    robots: Sequence[int], goals: Array, farther: Array, tasks: Array, radii: Array
) -> None:
    """Send robots that have nothing to do to the nearest place that is in nobody's way.

    One that did not get there, since somebody wants to come the other way, looks `farther` off.
    """
    if not len(tasks):
        return
    refuges = _refuges(tasks, radii)
    for robot in robots:
        is_clear = (np.linalg.norm(goals[robot] - tasks, axis=1) >= radii).all()
        if is_clear or not len(refuges):
            continue
        away = np.linalg.norm(refuges - goals[robot], axis=1)
        nearest = np.abs(away - farther[robot]).argmin() if farther[robot] else away.argmin()
        goals[robot] = refuges[nearest]
        refuges = refuges[np.linalg.norm(refuges - goals[robot], axis=1) > SPACING]


def _refuges(tasks: Array, radii: Array) -> Array:
    """Return the points of a lattice (points, 2) that lie outside all radii around tasks."""
    columns = np.arange(-WIDTH / 2, WIDTH / 2, LATTICE) + LATTICE / 2
    rows = np.arange(-HEIGHT / 2, HEIGHT / 2, LATTICE) + LATTICE / 2
    points = np.stack(np.meshgrid(columns, rows), axis=-1).reshape(-1, 2)
    away = np.linalg.norm(points[:, None] - tasks[None], axis=2)  # (points, tasks)
    clear: Array = points[fits(points) & (away >= radii).all(axis=1)]
    return clear
