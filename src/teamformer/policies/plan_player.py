"""Plays a schedule under the step rules: which robot goes where becomes splits, joins and tasks."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from teamformer.model import Scenario
from teamformer.sim.arrays import NOBODY, Array
from teamformer.sim.env import Decision, TeamFormation


class PlanPlayer:
    """Sends every robot along its route of tasks.

    A team whose members have the same next task goes there and joins, pair by pair, the teams
    there that wait for it too. A team whose members part ways splits. Robots with the same
    capabilities and speed are interchangeable: where the step rules let another one stay than the
    plan has it, the two exchange their routes.
    """

    def __init__(self, scenario: Scenario, routes: Sequence[Sequence[int]]) -> None:
        self._routes = [list(route) for route in routes]
        self._kind = [
            (tuple(sorted(robot.can.items())), robot.speed, robot.lost) for robot in scenario.robots
        ]
        self._counts = np.array(
            [
                [robot.can.get(name, 0) for name in scenario.capabilities]
                for robot in scenario.robots
            ],
            dtype=np.int16,
        )

    def decide_in(self, env: TeamFormation) -> Decision:
        """Return every team's decision in the first world of an environment."""
        world_tasks, teams = env.worlds.tasks[0], env.worlds.teams[0]
        self._is_done = world_tasks["done_at"] != NOBODY
        slots = np.flatnonzero(teams["size"]).tolist()
        robots_of = {slot: np.flatnonzero(env.worlds.robots["team"][0] == slot) for slot in slots}
        wanted = {slot: env.worlds.has[0, slot].copy() for slot in slots}
        named = dict.fromkeys(slots, NOBODY)
        waiting: dict[int, list[int]] = {}  # teams at their next task, by task
        for slot in slots:
            robots = robots_of[slot].tolist()
            ways = sorted({task for r in robots if (task := self._next(r)) != NOBODY})
            if teams[slot]["serves"] > 0 or not ways:
                continue
            first = min(self._next(r) for r in robots if self._next(r) != NOBODY)
            if len(ways) > 1:
                wanted[slot] = self._part(robots, first)
            elif (teams[slot]["x"], teams[slot]["y"]) == tuple(world_tasks[first][["x", "y"]]):
                waiting.setdefault(first, []).append(slot)
            if world_tasks[first]["is_open"]:
                named[slot] = first
        for together in waiting.values():
            for one, other in zip(together[::2], together[1::2], strict=False):
                wanted[one] = wanted[one] + wanted[other]
        return Decision(
            np.array([wanted[slot] for slot in slots]), np.array([named[slot] for slot in slots])
        )

    def _next(self, robot: int) -> int:
        """Return the robot's next task that is not done, or NOBODY."""
        return next((task for task in self._routes[robot] if not self._is_done[task]), NOBODY)

    def _part(self, robots: list[int], task: int) -> Array:
        """Return the counts to keep so that those who go to `task`, or nowhere, stay."""
        stay = [robot for robot in robots if self._next(robot) in (task, NOBODY)]
        for part in (stay, [robot for robot in robots if robot not in stay]):
            wanted: Array = self._counts[part].sum(axis=0)
            kept = self._stayers(robots, wanted)
            if sorted(self._kind[r] for r in kept) == sorted(self._kind[r] for r in part):
                self._exchange_routes(part, kept)
                return wanted
        return np.asarray(self._counts[robots[0]])  # the first one always stays alone

    def _stayers(self, robots: list[int], wanted: Array) -> list[int]:
        """Return who stays by the step rules: robots in order while they fit."""
        stay, room = [], wanted.copy()
        for robot in robots:
            if (self._counts[robot] <= room).all():
                stay.append(robot)
                room -= self._counts[robot]
        return stay

    def _exchange_routes(self, planned: list[int], kept: list[int]) -> None:
        """Give the robots that stay the routes of those that were meant to."""
        leavers = [robot for robot in planned if robot not in kept]
        for robot in kept:
            if robot not in planned:
                twin = next(r for r in leavers if self._kind[r] == self._kind[robot])
                leavers.remove(twin)
                routes = self._routes
                routes[robot], routes[twin] = routes[twin], routes[robot]
