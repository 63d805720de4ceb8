"""Who may begin in a zone: teams enter in the order of the plan that all who count have agreed on.

A task may begin if fewer tasks than there is room for come before it in that order, or are under
way, and are not over. So as long as all go by one plan there is room for whoever begins, whatever
is lost on the network. Nobody begins by a plan that the others are not known to follow.
"""

from __future__ import annotations

from collections.abc import Iterator

from teamformer.fleet.agent.knowledge import NEVER, Knowledge
from teamformer.fleet.agent.membership import Membership
from teamformer.fleet.agent.planning import PlanKeeper
from teamformer.fleet.in_zones import FleetZones
from teamformer.fleet.messages import SERVE, Word

LONG_AGO = float("-inf")

FRESH = 5.0
"""Seconds for which it holds that somebody was heard to follow a plan."""

LEFT_OUT = 10.0
"""Seconds in which nobody begins after a plan that leaves robots out.

In them these robots may still begin by the plan before."""


class ZoneGate:
    """What one robot knows of who may begin where there is room for so many only."""

    def __init__(self, knowledge: Knowledge, membership: Membership, keeper: PlanKeeper) -> None:
        self._knowledge, self._membership, self._keeper = knowledge, membership, keeper
        self._zones = FleetZones(knowledge.mission)
        self._shown = [(0, LONG_AGO)] * knowledge.mission.robots  # a plan, and when it was heard of

    def hear(self, word: Word, now: float) -> bool:
        """Note by a new word which plan a robot follows; say whether it is now that of this one."""
        if word.terms is None or word.is_lost:
            return False
        before, _ = self._shown[word.robot]
        self._shown[word.robot] = word.terms.plan, now
        return before != word.terms.plan == self._keeper.plan.version[2]

    def lets_in(self, goal: int, now: float) -> bool:
        """Say whether a task may begin by the zones that it is in."""
        task = self._knowledge.tasks.get(goal)
        zones = self._zones.of(task) if task is not None and self._zones.rooms else []
        if not zones:
            return True
        if not self._is_agreed(now):
            return False
        others = {*self._ahead(goal), *self._under_way(now)} - {goal}
        return all(self._has_room(zone, others) for zone in zones)

    def _is_agreed(self, now: float) -> bool:
        """Say whether all robots of the plan were heard to follow it not long ago.

        Robots that it leaves out may have gone on for a while by the plan before.
        """
        plan = self._keeper.plan
        counts_on_all = len(plan.live) == self._knowledge.mission.robots
        if not counts_on_all and now < self._keeper.dropped_at + LEFT_OUT:
            return False
        shown = (self._shown[robot] for robot in plan.live - {self._knowledge.me})
        own = plan.version[2]
        return all(theirs == own and now - heard <= FRESH for theirs, heard in shown)

    def _has_room(self, zone: int, others: set[int]) -> bool:
        """Say whether a zone has room beside those of other tasks that are in it."""
        tasks = self._knowledge.tasks
        inside = [key for key in others if key not in tasks or zone in self._zones.of(tasks[key])]
        return len(inside) < self._zones.rooms[zone]

    def _ahead(self, goal: int) -> Iterator[int]:
        """Yield the tasks before another one in the plan that are to begin, or have begun."""
        knowledge, plan = self._knowledge, self._keeper.plan
        for key, robots in plan.stops:
            if key == goal:
                return
            is_planned = key not in knowledge.over and key not in plan.idle
            if is_planned and (key not in knowledge.tasks or knowledge.begins(robots, key) < NEVER):
                yield key

    def _under_way(self, now: float) -> Iterator[int]:
        """Yield the tasks that others are at work on by their words.

        Who is called lost counts for as long as its task is believed to take.
        """
        knowledge, seen = self._knowledge, self._membership.seen
        for word in knowledge.words:
            is_serving = word.phase == SERVE and word.goal in knowledge.undone
            if not is_serving or word.robot == knowledge.me:
                continue
            takes = knowledge.mission.takes(knowledge.tasks[word.goal], (word.robot,))
            if not word.is_lost or now - seen[word.robot] <= takes:
                yield word.goal
