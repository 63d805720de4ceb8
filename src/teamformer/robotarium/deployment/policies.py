"""Methods that the testbed can run, and what makes their policies there."""

from __future__ import annotations

from typing import NamedTuple

from teamformer.base.errors import TeamformerError
from teamformer.methods.learned.shipped import ANY_FLEET, NAME, shipped_cards
from teamformer.methods.listings import DEFAULT, STAND_IN


class Maker(NamedTuple):
    """A function of the package that returns a policy, and the networks that it reads."""

    module: str  # of the package, dotted
    function: str
    arguments: tuple[str | int, ...] = ()
    networks: tuple[str, ...] = ()  # files of weights/


WITHOUT_SIZE = {
    ANY_FLEET: Maker("methods.learned.any_fleet", "teamformer", (), (f"{ANY_FLEET}.onnx",)),
    "heuristic": Maker("methods.scripted.heuristic", "Heuristic"),
    "join-all": Maker("methods.scripted.joining", "JoinAll"),
    "join-fitting": Maker("methods.scripted.join_fitting", "JoinFitting"),
}


def maker_of(name: str) -> Maker:
    """Return what makes the policy of a method on the testbed.

    Raises `TeamformerError` for a method that has no form there.
    """
    if name in WITHOUT_SIZE:
        return WITHOUT_SIZE[name]
    papers = [card.name for card in shipped_cards() if card.name not in WITHOUT_SIZE]
    found = NAME.fullmatch(name)
    if found is None or name not in papers:
        hint = f"use {', '.join([*WITHOUT_SIZE, *papers])}"
        if name in (DEFAULT, STAND_IN):
            raise TeamformerError("the testbed is too slow for plans: it has no numba", hint)
        raise TeamformerError(f"method '{name}' cannot be deployed", hint)
    if found[1] == "teamformer":
        files = (f"{name}.onnx", f"{name}-step.onnx")
        return Maker("methods.learned.autoregressive", "shipped_spelling", (name,), files)
    given = (name, int(found[2]))
    return Maker("methods.learned.combinations", "shipped_combining", given, (f"{name}.onnx",))
