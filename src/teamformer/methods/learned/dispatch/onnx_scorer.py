"""The network that scores offers, from its file."""

from __future__ import annotations

import numpy as np

from teamformer.base.array_types import Array
from teamformer.methods.learned.dispatch.giving_out import Scorer
from teamformer.methods.learned.dispatch.offers import MOST_OFFERS, OFFER_INPUTS
from teamformer.methods.learned.onnx_sessions import OnnxNetwork, shipped

NAME = "teamformer-tasks"


class OnnxScorer:
    """Scores offers by a network's file; raises `TeamformerError` for another file."""

    def __init__(self, content: bytes, name: str) -> None:
        self._network = OnnxNetwork(content, name, OFFER_INPUTS)

    def __call__(self, features: Array, count: Array) -> Array:
        """Return the scores of offers, as (rows, most offers) float64."""
        is_offer = np.arange(MOST_OFFERS) < count[:, None]
        [scores] = self._network(features, is_offer)
        scored: Array = scores.astype(np.float64)
        return scored


def shipped_scorer() -> Scorer:
    """Return the scorer that comes with the package."""
    return OnnxScorer(shipped(f"{NAME}.onnx"), NAME)
