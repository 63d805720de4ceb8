"""The layout of features leaves no gap and names no number twice."""

from __future__ import annotations

from enum import IntEnum
from itertools import chain

import pytest

from teamformer.methods.learned import feature_layout as layout
from teamformer.methods.learned.relational_features import (
    OWN_FEATURES,
    TASK_FEATURES,
    TEAM_FEATURES,
)
from teamformer.methods.learned.token_features import TASK_FEATURES as TASK_TOKEN
from teamformer.methods.learned.token_features import TEAM_FEATURES as TEAM_TOKEN


@pytest.mark.parametrize(
    ("parts", "length"),
    [
        ((layout.OwnRelation,), OWN_FEATURES),
        ((layout.TeamRelation,), TEAM_FEATURES),
        ((layout.TaskRelation,), TASK_FEATURES),
        ((layout.PlaceToken, layout.OwnToken, layout.SeenToken), TEAM_TOKEN),
        ((layout.PlaceToken, layout.TaskToken), TASK_TOKEN),
    ],
)
def test_every_number_of_a_token_has_a_name(parts: tuple[type[IntEnum], ...], length: int) -> None:
    assert {int(feature) for feature in chain(*parts)} == set(range(length))
    for part in parts:
        assert len(part.__members__) == len(part)  # no alias: a number has one name
