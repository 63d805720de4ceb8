"""What a robot's body is to do: where to go, by way of which charger, whether to serve there."""

from __future__ import annotations

from typing import TYPE_CHECKING

from teamformer.fleet.bodies.body import Command
from teamformer.fleet.messages import READY, SERVE
from teamformer.mission.parts.grid import Place
from teamformer.world.rules.constants import NOBODY

if TYPE_CHECKING:
    from teamformer.fleet.agent.agent import Agent


class Pilot:
    """Turns the state of an agent into commands."""

    def __init__(self, agent: Agent) -> None:
        self._agent = agent

    def command(self, now: float) -> Command:
        """Return what the body is to do; only a new place or task is a new leg."""
        agent = self._agent
        service, command = agent.service, agent.command
        place, leg, duration, pace = self._by_charger(now), command.leg, 0.0, 0.0
        if service.goal != command.task or (place != command.place and not agent.is_bound):
            leg += 1
        if service.goal != NOBODY:
            duration = agent.knowledge.tasks[service.goal].duration
        is_serving = service.phase == SERVE
        agent.lets_go = agent.lets_go or (agent.carries and not is_serving)
        if is_serving and agent.has_load(service.goal):
            pace = min(agent.mission.paces[robot] for robot in service.team_here(now))
        new = Command(
            leg=leg,
            place=place,
            task=service.goal,
            team=service.team,
            serve=is_serving,
            duration=duration,
            pace=pace,
            charge=self._may_charge(now),
        )
        return command if new == command else new

    def _by_charger(self, now: float) -> Place | None:
        """Return where to go, by way of a charger if need be; None for staying where it is."""
        agent = self._agent
        service, goal, place = agent.service, agent.service.goal, self._place_to_be(now)
        is_bound = service.phase >= READY or now < service.promised or agent.is_bound
        if is_bound or (place is None and goal == NOBODY) or agent.mission.charging is None:
            agent.recharge.forget()
            return place
        if now < service.formed:
            return place
        to = agent.knowledge.place_of(goal) if place is None else place
        first = agent.recharge.by_way_of(
            agent.place, to, agent.knowledge.located(goal), agent.is_over, service.is_gathering
        )
        return place if first == to else first

    def _may_charge(self, now: float) -> bool:
        agent = self._agent
        if not agent.recharge.is_away:
            return False
        near = (w for w in agent.knowledge.words if agent.membership.is_near(w.robot, now))
        others = (word for word in near if word.robot != agent.me and not word.is_lost)
        return agent.recharge.may_charge(agent.place, others, agent.age(now))

    def _place_to_be(self, now: float) -> Place | None:
        """Return where to go; None for staying where it is, or with the load that it carries."""
        agent = self._agent
        service, command, goal = agent.service, agent.command, agent.service.goal
        if agent.carries and command.task == goal:
            return None
        place: Place | None = None
        if agent.has_served and command.task == goal:
            return command.place
        if agent.has_load(goal) and now < service.promised:
            return command.place  # it stays with the load, or where it has let it go
        is_idle = goal == NOBODY or agent.has_load(goal)
        if agent.membership.is_stuck and is_idle and agent.leads(agent.wanted):
            place = agent.wanted  # it goes on trying
        elif goal == NOBODY:
            is_home_bound = agent.is_over and agent.mission.ends
            missed = {} if is_home_bound else agent.meeting.missed(now, agent.ears.watched)
            place = agent.meeting.place(agent.place, missed, agent.age(now))
        elif now >= service.formed:
            is_here = command.task == goal and command.place is None and agent.is_at(goal)
            place = None if is_here else agent.knowledge.place_of(goal)
        if place is None and goal == command.task != NOBODY:
            return command.place  # forming where it stands
        return place
