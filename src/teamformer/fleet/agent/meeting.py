"""Where a robot goes that has no task: to meet those that it misses, else home.

They meet at a base. On roads somebody may be where no way leads on to that, and nobody may have
heard where. So those who miss others look at such places by turns, and go by the mission's age:
whoever looks for somebody is then where all others are who do.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping

from teamformer.fleet.agent.knowledge import Knowledge
from teamformer.fleet.agent.membership import Membership
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.roads import Roads


class Meeting:
    """Where one robot looks for others."""

    def __init__(self, knowledge: Knowledge, membership: Membership) -> None:
        self._knowledge, self._membership = knowledge, membership
        self._mission, self._me = knowledge.mission, knowledge.me
        self._base = base_of(self._mission, self._me)
        self._turns = turns(self._mission)

    def missed(self, now: float, watched: Collection[int]) -> dict[int, Place]:
        """Return who of those `watched` is out of hearing, and where it is or goes by its word."""
        seen, patience = self._membership.seen, 2 * self._mission.timers.near
        missed = (robot for robot in watched if now - seen[robot] > patience)
        return {robot: self._knowledge.heads_to(robot) for robot in missed}

    def place(self, here: Place, missed: Mapping[int, Place], age: float) -> Place | None:
        """Return where to go from `here`, to meet who is `missed`, if anybody; None for nowhere.

        `age` is how long the mission has been going on, in seconds.
        """
        if not missed:
            place = self._mission.home_of(self._me)
            return place if place is not None and self._leads(here, place) else None
        for place in (self._only_way(here, missed), self._turn(age), self._base):
            if place is not None and self._leads(here, place):
                return place
        return None

    def _leads(self, here: Place, place: Place) -> bool:
        return self._mission.leads(self._me, here, place)

    def _only_way(self, here: Place, missed: Mapping[int, Place]) -> Place | None:
        """Return where one is missed who cannot come to the base, if nobody comes back from there.

        Else there is a turn for that place.
        """
        if not isinstance(self._mission.source.world, Roads):
            return None
        for robot, at in sorted(missed.items()):
            place, is_kept = (at[0], 0), not self._mission.leads(robot, at, self._base)
            if is_kept and self._leads(here, place) and not self._leads(place, self._base):
                return place
        return None

    def _turn(self, age: float) -> Place | None:
        """Return the place whose turn it is; None if it is a base's, as every other turn is.

        Nobody goes where it cannot come back from.
        """
        number = int(age / turn_time(self._mission))
        place = self._turns[number // 2 % len(self._turns)] if number % 2 and self._turns else None
        return place if place is not None and self._leads(place, self._base) else None


def base_of(mission: FleetMission, robot: int) -> Place:
    """Return the start of the first robot to which another robot can get, and from it back."""
    at, others = mission.source.robots[robot].at, mission.source.robots
    if not isinstance(mission.source.world, Roads):
        return others[mission.regions.index(mission.regions[robot])].at
    starts = (other.at for other in others)
    return next(s for s in starts if mission.leads(robot, at, s) and mission.leads(robot, s, at))


def turns(mission: FleetMission) -> tuple[Place, ...]:
    """Return the places of roads where a robot can get to that cannot go on to a base then."""
    world, robots = mission.source.world, mission.source.robots
    if not isinstance(world, Roads):
        return ()
    alike = {(robot.at, robot.moves): number for number, robot in enumerate(robots)}
    bases = {base_of(mission, robot) for robot in alike.values()}
    leads, found = mission.leads, dict[Place, None]()
    for (at, _), robot in alike.items():
        ahead = ((n, 0) for n in range(len(world.places)) if leads(robot, at, (n, 0)))
        found |= {p: None for p in ahead if not all(leads(robot, p, base) for base in bases)}
    return tuple(sorted(found))


def turn_time(mission: FleetMission) -> float:
    """Return the seconds of a turn: all get there, and wait for as long as for word of others."""
    return mission.longest_walk + mission.timers.lost
