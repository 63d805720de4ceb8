"""The policy for any fleet: reads relations, chooses among whole choices."""

from __future__ import annotations

from teamformer.base.array_types import Array
from teamformer.methods.learned.macro_actions import wanted_counts
from teamformer.methods.learned.onnx_sessions import GreedyChoice, OnnxNetwork, shipped
from teamformer.methods.learned.policy import Learned
from teamformer.methods.learned.relational_features import Relations, relate
from teamformer.world.view import View

NAME = "teamformer"


class AnyFleetCodec:
    """Reads relations, which belong to no capability; an action is a choice, (teams,)."""

    def encode(self, view: View) -> Relations:
        """Return each team's relations."""
        return relate(view)

    def has_choice(self, view: View, tokens: tuple[Array, ...]) -> Array:
        """Return which teams may do something else than the script, as (teams,)."""
        is_open: Array = Relations(*tokens).is_legal.sum(axis=1) > 1
        return is_open

    def decode(self, view: View, action: Array) -> Array:
        """Return the counts that choices stand for, as (teams, caps)."""
        return wanted_counts(view, action)


def any_fleet(content: bytes, name: str) -> Learned:
    """Return the policy that a network's file makes."""
    return Learned(AnyFleetCodec(), GreedyChoice(OnnxNetwork(content, name, Relations._fields)))


def teamformer() -> Learned:
    """Return the policy that comes with the package."""
    return any_fleet(shipped(f"{NAME}.onnx"), NAME)
