"""The seam between views and a network: what it reads and what its actions stand for."""

from __future__ import annotations

from typing import Protocol, runtime_checkable

from teamformer.base.array_types import Array
from teamformer.world.view import View


class Codec(Protocol):
    """Reads views into tokens and writes actions as wanted counts.

    A codec is made for nothing in particular: it keeps no state between views. Row i of whatever
    it returns belongs to row i of the view.
    """

    def encode(self, view: View) -> tuple[Array, ...]:
        """Return the network's inputs, each (teams, ...): float32, int64 or bool."""
        ...

    def has_choice(self, view: View, tokens: tuple[Array, ...]) -> Array:
        """Return which teams have more than one legal action, as (teams,) bool.

        `Learned` says what the others do.
        """
        ...

    def decode(self, view: View, action: Array) -> Array:
        """Return the counts that actions (teams, ...) stand for, as (teams, caps) int16."""
        ...


@runtime_checkable
class ImitatingCodec(Codec, Protocol):
    """A codec that also knows the action for what somebody else decided."""

    def action_for(self, view: View, wanted: Array) -> Array:
        """Return the actions (teams, ...) int64 that stand for legal counts (teams, caps)."""
        ...
