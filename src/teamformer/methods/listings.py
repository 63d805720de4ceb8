"""Which methods can be named, and what is said of them: those of packages, and our networks."""

from __future__ import annotations

import inspect
from dataclasses import dataclass
from typing import Any

from teamformer.base.entry_points import OURS, Brought, brought, find_brought, names_of
from teamformer.base.errors import TeamformerError
from teamformer.methods.learned.shipped import shipped_cards

DEFAULT, STAND_IN = "plan", "crews"
"""What is chosen for a mission, and for one that is too large to share a plan soon."""

CARDS = {card.name: card for card in shipped_cards()}
"""The networks that come with the package, by name."""


@dataclass(frozen=True)
class Listing:
    """A method that can be named: what to say of it, and which package brings it."""

    name: str
    summary: str
    tasks_by: str = "the paper's order"
    trained_on: str = "nothing to train"
    package: str = OURS


def method_names() -> tuple[str, ...]:
    """Return the names of all methods: the default first, then ours, networks, other packages'."""
    ours = [one.name for one in brought("method") if one.is_ours]
    ours.sort(key=lambda name: name != DEFAULT)
    return tuple(dict.fromkeys([*ours, *CARDS, *names_of("method")]))


def our_method_names() -> tuple[str, ...]:
    """Return the names of the methods that come with Teamformer."""
    ours = {*CARDS, *(one.name for one in brought("method") if one.is_ours)}
    return tuple(name for name in method_names() if name in ours)


def find_method(name: str) -> Brought | None:
    """Return the method that a package brings under a name; raises what `find_brought` does."""
    return find_brought("method", name, CARDS)


def method_listings() -> list[Listing]:
    """Return what to say of each method; of one that cannot be loaded, why."""
    cards = [
        Listing(card.name, card.summary, trained_on=card.trained_on) for card in CARDS.values()
    ]
    listed = [_listing_of(one) for one in brought("method")]
    places = {name: place for place, name in enumerate(method_names())}
    return sorted([*cards, *listed], key=lambda listing: places[listing.name])


def _listing_of(one: Brought) -> Listing:
    try:
        made = one.load()
    except TeamformerError as error:
        return Listing(one.name, str(error), "", "", one.package)
    about = (inspect.getdoc(made) or "").partition("\n\n")[0]
    summary = " ".join(about.split()).removesuffix(".")
    return Listing(one.name, summary, _who_says_tasks(made), package=one.package)


def _who_says_tasks(made: Any) -> str:
    """Return who says the tasks: teams go by the plan of a coordinator or of a planner."""
    if not isinstance(made, type):
        return ""
    is_planning = hasattr(made, "update") or hasattr(made, "plan")
    return "its own plan" if is_planning else Listing.tasks_by
