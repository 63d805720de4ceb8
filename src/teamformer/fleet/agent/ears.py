"""Whom a robot listens to: in a small fleet everybody, in a large one neighbours and partners.

Where there are zones all have to agree on who enters, so there everybody listens to everybody.
"""

from __future__ import annotations

from teamformer.fleet.agent.membership import HEARS_ALL, Membership, neighbours
from teamformer.fleet.agent.planning import FleetPlan
from teamformer.fleet.fleet_mission import FleetMission


class Ears:
    """The robots that one robot, `me`, listens to: those `watched`."""

    def __init__(self, mission: FleetMission, me: int) -> None:
        self._is_small = mission.robots <= HEARS_ALL or bool(mission.source.zones)
        self._me = me
        self._neighbours = neighbours(me, mission.robots)
        others = frozenset(range(mission.robots)) - {me}
        self.watched = others if self._is_small else self._neighbours
        self._watched_for = (-1, -1)  # the goal and the plan that it listens for

    def listen_for(self, goal: int, plan: FleetPlan, membership: Membership, now: float) -> None:
        """In a large fleet, listen to neighbours and to those that this robot is to meet."""
        if self._is_small or (goal, plan.note.epoch) == self._watched_for:
            return
        self._watched_for = (goal, plan.note.epoch)
        watched = self._neighbours | frozenset(plan.coalition(goal)) - {self._me}
        membership.watch(watched - self.watched, now)
        self.watched = watched
