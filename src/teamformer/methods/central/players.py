"""What central plays beforehand: plans, policies and coordinators, each on a stage of its own."""

from __future__ import annotations

from typing import TypeGuard, cast

from teamformer.methods.central.plan_player import PlanPlayer
from teamformer.methods.coordinators.on_command import OnCommand
from teamformer.methods.seam.protocol import Policy
from teamformer.mission.coordination import Coordinator
from teamformer.mission.model import Mission
from teamformer.world.env import Decision, TeamFormation
from teamformer.world.view import View

Player = PlanPlayer | Policy | Coordinator


def is_coordinator(player: Player) -> TypeGuard[Coordinator]:
    """Say whether a player makes plans as the mission goes, and no decisions."""
    return not isinstance(player, PlanPlayer) and hasattr(player, "update")


def stage_for(player: Player, mission: Mission, truth: Mission) -> TeamFormation:
    """Return a world for a player: with its coordinator, if it is one or takes commands."""
    coordinator: Coordinator | None = None
    if isinstance(player, PlanPlayer):
        coordinator = OnCommand(player.left_out)
    elif is_coordinator(player):
        coordinator = player
    return TeamFormation([mission], truths=[truth], coordinator=coordinator)


def decision_of(player: Player, env: TeamFormation, view: View) -> Decision:
    """Return what a player decides for the teams of a view."""
    if isinstance(player, PlanPlayer):
        return player.decide_in(env)
    if is_coordinator(player):
        return env.planned_decision(view)
    policy = cast(Policy, player)
    return policy.decide(view)
