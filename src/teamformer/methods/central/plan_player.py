"""Plays a plan under the step rules: who does which task becomes splits, joins and tasks."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from teamformer.base.array_types import Array
from teamformer.mission.model import Mission
from teamformer.mission.parts.grid import Grid
from teamformer.mission.parts.shifts import fits_now
from teamformer.mission.parts.zones import rooms_of
from teamformer.planning.problem.relaxed_problem import count_table
from teamformer.world.env import Decision, TeamFormation
from teamformer.world.rules.constants import NOBODY


class PlanPlayer:
    """Sends every robot along its route of tasks.

    A team whose members have the same next task goes there and joins, pair by pair, the teams
    there that wait for it too. A team whose members part ways splits, those of the earliest task
    in the plan's order first; who has nothing left to do stays behind. Robots with the same
    capabilities and speed are interchangeable: where the step rules let another one stay than the
    plan has it, the two exchange their routes. Robots that the rules cannot part go to the earliest
    task together. So the coalition of the earliest open task is always on its way there, and
    nothing is parted and joined again for ever. Zones are entered in the plan's order: before its
    turn a team that stands at its task names none.
    """

    def __init__(
        self,
        mission: Mission,
        routes: Sequence[Sequence[int]],
        order: Sequence[int] | None = None,
    ) -> None:
        order = range(len(mission.tasks)) if order is None else order
        self._rank = {task: place for place, task in enumerate(order)}
        self._routes = [list(route) for route in routes]
        self._at = [0] * len(routes)  # how far on its route each robot is
        planned = {task for route in routes for task in route}
        self.left_out = frozenset(range(len(mission.tasks))) - planned
        self._places = np.array([task.at for task in mission.tasks], dtype=np.float64)
        world = mission.world
        self._near = 0.0 if isinstance(world, Grid) else world.arrival_radius
        self._reach = max(mission.join_radius, self._near)
        self._kind = [
            repr((sorted(r.can.items()), r.speed, r.flies, r.absences, r.rota, r.battery))
            for r in mission.robots
        ]
        self._rotas = [robot.rota for robot in mission.robots]
        self._rooms = rooms_of(mission)
        self._planned = planned
        self._counts = count_table([robot.can for robot in mission.robots], mission)

    def decide_in(self, env: TeamFormation) -> Decision:
        """Return every team's decision in the first world of an environment."""
        tasks, teams = env.worlds.tasks[0], env.worlds.teams[0]
        is_done = (tasks["done_at"] != NOBODY) | (tasks["missed_at"] != NOBODY)
        self._is_done = is_done.tolist()  # or missed
        self._is_open = tasks["is_open"]
        members: dict[int, list[int]] = {}
        for robot, slot in enumerate(env.worlds.robots["team"][0][: len(self._routes)].tolist()):
            if slot != NOBODY:
                members.setdefault(slot, []).append(robot)
        slots = sorted(members)
        wanted = {slot: env.worlds.has[0, slot].copy() for slot in slots}
        named = dict.fromkeys(slots, NOBODY)
        waiting: dict[int, int] = {}  # the team at its next task that nobody joins yet, by task
        steps = int(env.worlds.count["steps"][0])
        serves, x, y = (teams[field].tolist() for field in ("serves", "x", "y"))
        is_charging = (teams["charger"] != NOBODY).tolist()
        for slot in slots:
            ways = self._ways(members[slot])
            if serves[slot] > 0 or not ways:
                continue
            parted = self._part(members[slot], ways)
            if parted is not None:
                wanted[slot] = parted
            elif (
                not is_charging[slot]
                and self._is_at(ways[0], x[slot], y[slot])
                and fits_now([self._rotas[robot] for robot in members[slot]], steps, 1)
            ):
                other = waiting.setdefault(ways[0], slot)
                if other != slot and self._is_in_reach(x[slot] - x[other], y[slot] - y[other]):
                    wanted[other] = wanted[other] + wanted[slot]
                    del waiting[ways[0]]
            named[slot] = self._open_task(ways[0])
            if self._rooms and self._is_held(tasks, named[slot], x[slot], y[slot]):
                named[slot] = NOBODY
        return Decision(
            np.array([wanted[slot] for slot in slots]), np.array([named[slot] for slot in slots])
        )

    def _is_held(self, tasks: Array, task: int, x: float, y: float) -> bool:
        """Say whether a team stands at a task in a zone of which it is not the turn yet.

        There is no room for it and for all others before it in the plan that are not over then.
        """
        if task == NOBODY or not self._is_at(task, x, y):
            return False
        rank, ends = (
            self._rank,
            (tasks["served"] + 1 >= tasks["takes"]) & (tasks["server"] != NOBODY),
        )
        is_over = self._is_done | tasks["is_carried"][: len(self._is_done)]
        first = {k for k in self._planned if rank[k] < rank[task] and not is_over[k]}
        ahead = {k for k in first if not ends[k]}
        rooms = (room for room in self._rooms if task in room.tasks)
        return any(len(room.tasks & ahead) >= room.room for room in rooms)

    def _next(self, robot: int) -> int:
        """Return the robot's next task that is not done, or NOBODY."""
        route, at = self._routes[robot], self._at[robot]
        while at < len(route) and self._is_done[route[at]]:
            at += 1
        self._at[robot] = at
        return route[at] if at < len(route) else NOBODY

    def _ways(self, robots: list[int]) -> list[int]:
        """Return the different next tasks of robots, in the plan's order."""
        ways = {self._next(robot) for robot in robots} - {NOBODY}
        return sorted(ways, key=self._rank.__getitem__)

    def _is_at(self, task: int, x: float, y: float) -> bool:
        task_x, task_y = self._places[task]
        return bool((task_x - x) ** 2 + (task_y - y) ** 2 <= self._near**2)

    def _is_in_reach(self, along: float, up: float) -> bool:
        return along * along + up * up <= self._reach * self._reach

    def _open_task(self, task: int) -> int:
        """Return a task to head for: the one given, or the open one nearest to it."""
        if self._is_open[task]:
            return task
        away = np.abs(self._places - self._places[task]).sum(axis=1)  # (tasks,)
        away[~self._is_open[: len(away)]] = np.inf
        return int(away.argmin()) if np.isfinite(away.min()) else NOBODY

    def _part(self, robots: list[int], ways: list[int]) -> Array | None:
        """Return the counts to keep so that those of one way, or all others, stay.

        None if nobody parts, or the rules allow no such split.
        """
        for task in ways:
            stay = [robot for robot in robots if self._next(robot) == task]
            rest = [robot for robot in robots if robot not in stay]
            if not rest:
                return None
            for part in (stay, rest):
                wanted: Array = self._counts[part].sum(axis=0, dtype=np.int32)
                kept = self._stayers(robots, wanted)
                if sorted(self._kind[r] for r in kept) == sorted(self._kind[r] for r in part):
                    self._exchange_routes(part, kept)
                    return wanted
        return None

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
                routes, at = self._routes, self._at
                routes[robot], routes[twin] = routes[twin], routes[robot]
                at[robot], at[twin] = at[twin], at[robot]
