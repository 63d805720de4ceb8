"""The learned policies that come with the package: listed from the cards beside their weights."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.resources import files
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from teamformer.methods.learned.policy import Learned

ANY_FLEET = "teamformer"
NAME = re.compile(r"(teamformer|deepset|gnn)-c(\d+)(-ppo)?")
"""A network of the paper for a number of capabilities: taught by a script, or by PPO."""

NETWORKS = {
    "teamformer": "The paper's transformer",
    "deepset": "The paper's deep set with attention",
    "gnn": "The paper's graph network",
}


@dataclass(frozen=True)
class Card:
    """What to say of a policy that comes with the package."""

    name: str
    summary: str
    trained_on: str


def shipped_cards() -> Iterator[Card]:
    """Yield a card for each policy whose weights and description are in the package."""
    names = [
        file.name.removesuffix(".md") for file in files("teamformer").joinpath("weights").iterdir()
    ]
    yield Card(
        ANY_FLEET,
        "The best learned policy; says where to deviate from join-fitting",
        "any number of capabilities",
    )
    found = [match for name in names if (match := NAME.fullmatch(name))]
    families = list(NETWORKS)
    for name in sorted(found, key=lambda it: (families.index(it[1]), int(it[2]), it[0])):
        how = "by PPO from nothing" if name[3] else "taught by join-fitting"
        yield Card(name[0], f"{NETWORKS[name[1]]}, {how}", f"up to {name[2]} capabilities")


def shipped_policy(name: str) -> Learned:
    """Return a policy that comes with the package, by the name on its card."""
    if name == ANY_FLEET:
        from teamformer.methods.learned.any_fleet import teamformer

        return teamformer()
    found = NAME.fullmatch(name)
    assert found is not None, f"{name} has no card"
    if found[1] == "teamformer":
        from teamformer.methods.learned.autoregressive import shipped_spelling

        return shipped_spelling(name)
    from teamformer.methods.learned.combinations import shipped_combining

    return shipped_combining(name, int(found[2]))
