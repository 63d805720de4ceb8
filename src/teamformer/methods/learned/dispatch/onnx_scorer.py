"""The network that scores offers, from its file."""

from __future__ import annotations

import numpy as np

from teamformer.base.array_types import Array
from teamformer.methods.learned.dispatch.giving_out import Scorer
from teamformer.methods.learned.dispatch.offers import MOST_OFFERS, OFFER_INPUTS
from teamformer.methods.learned.onnx_sessions import OnnxNetwork, shipped

NAME = "teamformer-tasks"


def onnx_scorer(content: bytes, name: str) -> Scorer:
    """Return the scorer that a network's file makes; raises `TeamformerError` for another file."""
    network = OnnxNetwork(content, name, OFFER_INPUTS)

    def score(features: Array, count: Array) -> Array:
        is_offer = np.arange(MOST_OFFERS) < count[:, None]
        [scores] = network(features, is_offer)
        scored: Array = scores.astype(np.float64)
        return scored

    return score


def shipped_scorer() -> Scorer:
    """Return the scorer that comes with the package."""
    return onnx_scorer(shipped(f"{NAME}.onnx"), NAME)
