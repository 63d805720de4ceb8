"""The JSON Schema and the reader agree on drawn missions, and on broken ones."""

from __future__ import annotations

from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st
from jsonschema import Draft202012Validator

from edits import edited_trees
from missions import continuous_missions, missions
from teamformer.base.errors import TeamformerError
from teamformer.files.mission_files import mission_from_tree
from teamformer.files.schema import mission_schema

VALIDATOR = Draft202012Validator(mission_schema())
FOUND = 0.85
"""The share of what the reader refuses that the schema finds too, at least."""


def is_accepted(tree: Any) -> bool:
    """Say whether the reader accepts a tree."""
    try:
        mission_from_tree(tree)
    except TeamformerError:
        return False
    return True


def test_the_schema_accepts_what_is_drawn() -> None:
    @settings(max_examples=200, derandomize=True, database=None)
    @given(mission=st.one_of(missions(), continuous_missions()))
    def look(mission: Any) -> None:
        assert not list(VALIDATOR.iter_errors(mission))

    look()


def test_what_the_schema_refuses_the_reader_refuses() -> None:
    refused, found = 0, 0

    @settings(max_examples=500, derandomize=True, database=None)
    @given(mission=edited_trees())
    def look(mission: Any) -> None:
        nonlocal refused, found
        is_good, has_schema = is_accepted(mission), VALIDATOR.is_valid(mission)
        assert has_schema or not is_good
        refused += not is_good
        found += not has_schema

    look()
    assert found >= FOUND * refused
