"""The kinds of network that can be trained, by name."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from torch import nn

from teamformer.base.errors import TeamformerError
from teamformer.files.drawn.generate import Spec
from teamformer.learning.algorithms.ppo import PpoSettings
from teamformer.learning.export.autoregressive import export_teamformer
from teamformer.learning.export.combinations import export_combinations
from teamformer.learning.export.onnx_export import export_any_fleet, export_offers
from teamformer.learning.nets.deepset import CombinationSettings, DeepSet
from teamformer.learning.nets.gnn import GraphNetwork
from teamformer.learning.nets.offers import OfferNetwork, OfferSettings
from teamformer.learning.nets.relational import RelationalPolicy, RelationalSettings
from teamformer.learning.nets.teamformer import Teamformer, TeamformerSettings
from teamformer.learning.training_worlds import (
    ANY_MIXTURE,
    ANY_SELECTION,
    Mixture,
    paper_mixture,
    paper_selection,
)
from teamformer.methods.learned import relational_features as relational
from teamformer.methods.learned import token_features as tokens
from teamformer.methods.learned.action_mask import EDIT, FULL
from teamformer.methods.learned.any_fleet import AnyFleetCodec
from teamformer.methods.learned.codec import Codec
from teamformer.methods.learned.combinations import CombinationCodec, task_features, team_features
from teamformer.methods.learned.dispatch.offers import FEATURES, OfferFeature
from teamformer.methods.learned.token_features import SpellingCodec


@dataclass(frozen=True)
class Architecture:
    """A kind of network; `capabilities` is None for one that serves any number."""

    make: Callable[[int | None], nn.Module]
    codec: Callable[[int | None], Codec] | None  # None: it reads no views
    export: Callable[[nn.Module, int | None, Path], None]  # writes ONNX files into a folder
    mixture: Callable[[int | None], Mixture]
    selection: Callable[[int | None], tuple[Spec, ...]]
    is_for_any_number: bool = False
    methods: tuple[str, ...] = ("ppo", "imitation")  # that it can learn by, its own first
    ppo: PpoSettings = field(default_factory=PpoSettings)

    def codec_for(self, capabilities: int | None) -> Codec:
        """Return what reads views for it."""
        assert self.codec is not None, "it reads no views"
        return self.codec(capabilities)


def _make_any(capabilities: int | None) -> nn.Module:
    return RelationalPolicy(
        RelationalSettings(
            relational.OWN_FEATURES,
            relational.TEAM_FEATURES,
            relational.TASK_FEATURES,
        )
    )


def _spells(how: str, maintain_bias: float) -> Architecture:
    """Return the paper's network, with one of its two spellings."""

    def make(capabilities: int | None) -> nn.Module:
        return Teamformer(
            TeamformerSettings(
                _given(capabilities),
                tokens.TEAM_FEATURES,
                tokens.TASK_FEATURES,
                how,
                maintain_bias=maintain_bias,
            )
        )

    return Architecture(
        make=make,
        codec=lambda capabilities: SpellingCodec(_given(capabilities)),
        export=export_teamformer,
        mixture=paper_mixture,
        selection=paper_selection,
    )


def _given(capabilities: int | None) -> int:
    assert capabilities is not None  # find_architecture has seen to it
    return capabilities


def _combines(network: type[DeepSet] | type[GraphNetwork], width: int) -> Architecture:
    """Return a network over the paper's original action space."""

    def make(capabilities: int | None) -> nn.Module:
        caps = _given(capabilities)
        return network(
            CombinationSettings(
                team_features(caps), task_features(caps), 2 ** (caps + 1), width=width
            )
        )

    return Architecture(
        make=make,
        codec=lambda capabilities: CombinationCodec(_given(capabilities)),
        export=export_combinations,
        mixture=lambda capabilities: paper_mixture(
            capabilities, robots=max(4, _given(capabilities))
        ),
        selection=paper_selection,
    )


ANY_PPO = PpoSettings(
    learning_rate=1e-3,
    last_learning_rate=1e-4,
    epochs=3,
    entropy=0.001,
    last_entropy=0.0,
    minibatch=1024,
)
"""Few decisions deviate from the script at first, so that more is made of each."""


def _make_offers(capabilities: int | None) -> nn.Module:
    return OfferNetwork(OfferSettings(FEATURES, int(OfferFeature.BEGINS)))


ARCHITECTURES = {
    "tasks": Architecture(
        make=_make_offers,
        codec=None,
        export=export_offers,
        mixture=lambda capabilities: ANY_MIXTURE,
        selection=lambda capabilities: (),
        is_for_any_number=True,
        methods=("deviations", "samples"),
    ),
    "any": Architecture(
        make=_make_any,
        codec=lambda capabilities: AnyFleetCodec(),
        export=export_any_fleet,
        mixture=lambda capabilities: ANY_MIXTURE,
        selection=lambda capabilities: ANY_SELECTION,
        is_for_any_number=True,
        methods=("rollouts", "ppo"),
        ppo=ANY_PPO,
    ),
    "teamformer": _spells(EDIT, maintain_bias=2.0),
    "teamformer-full": _spells(FULL, maintain_bias=3.0),
    "teamformer-paper": _spells(FULL, maintain_bias=0.0),
    "deepset": _combines(DeepSet, width=64),
    "gnn": _combines(GraphNetwork, width=32),
}


def find_architecture(network: str, capabilities: int | None) -> Architecture:
    """Return an architecture.

    Raises `TeamformerError` if it is unknown or the number of capabilities does not fit.
    """
    architecture = ARCHITECTURES.get(network)
    if architecture is None:
        raise TeamformerError(
            f"there is no network '{network}'", f"use {' or '.join(ARCHITECTURES)}"
        )
    if architecture.is_for_any_number and capabilities is not None:
        hint = "leave capabilities out, or choose another network"
        raise TeamformerError(f"network '{network}' serves any number of capabilities", hint)
    if not architecture.is_for_any_number and capabilities is None:
        hint = "say it with capabilities: N"
        raise TeamformerError(f"network '{network}' is made for a number of capabilities", hint)
    if architecture.codec is not None:
        architecture.codec(capabilities)  # refuses numbers that its actions do not allow
    return architecture
