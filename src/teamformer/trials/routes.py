"""Where robots went in a recorded trial: their stops, read off the record."""

from __future__ import annotations

from collections.abc import Iterator

from teamformer.planning.coalitions.routes import Route, Stop
from teamformer.sim.replay.record import Replay, Step


def routes_of(replay: Replay) -> tuple[Route, ...]:
    """Return each robot's stops, in steps.

    A robot arrives in the step in which it comes to the task's place; work begins when it has the
    whole team there, as many steps before the end as the task takes.
    """
    fleet = _Fleet(replay)
    stops: list[list[Stop]] = [[] for _ in replay.scenario.robots]
    for number, step in enumerate(replay.steps, 1):
        fleet.follow(step, number)
        for task, slot in step.done:
            start = number - replay.mission.tasks[task].duration
            for robot in fleet.members[slot]:
                earlier = stops[robot][-1].end if stops[robot] else 0
                arrive = min(start, max(earlier, fleet.since[robot]))
                stops[robot].append(Stop(task, arrive, start, number))
    return tuple(
        Route(robot, tuple(made), made[-1].end if made else 0) for robot, made in enumerate(stops)
    )


class _Fleet:
    """Who is in which team, and since when in the same place."""

    def __init__(self, replay: Replay) -> None:
        self.members = {slot: list(robots) for slot, robots, _, _ in replay.start}
        self._place = {r: (x, y) for _, robots, x, y in replay.start for r in robots}
        self.since = dict.fromkeys(self._place, 0)

    def follow(self, step: Step, number: int) -> None:
        """Do what a step did: splits, joins, ways, losses."""
        for stay, leave in step.splits:
            self._regroup(stay, leave)
        for one, other in step.joins:
            self._regroup(self.members[one] + self.members[other])
        for team in step.teams:
            for robot in self._of(team.slot):
                if self._place[robot] != (team.x, team.y):
                    self._place[robot], self.since[robot] = (team.x, team.y), number
        for robot in step.lost:
            slot = next(slot for slot, robots in self.members.items() if robot in robots)
            self._regroup([other for other in self.members[slot] if other != robot], [robot])
            del self.members[robot]
        for robot in step.back:
            self.members[robot], self.since[robot] = [robot], number

    def _of(self, slot: int) -> Iterator[int]:
        """Return the robots of a team; one that lost its lowest robot is listed by its new slot."""
        for robots in self.members.values():
            if slot in robots:
                yield from robots

    def _regroup(self, *teams: list[int] | tuple[int, ...]) -> None:
        """Have robots in these teams from now on."""
        moved = {robot for team in teams for robot in team}
        for slot in [slot for slot, robots in self.members.items() if moved & set(robots)]:
            del self.members[slot]
        for team in teams:
            if team:
                self.members[min(team)] = sorted(team)
