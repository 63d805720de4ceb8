"""Settings by name, and the worlds they stand for."""

from __future__ import annotations

import pytest

from teamformer.base.errors import TeamformerError
from teamformer.files.drawn.generate import Spec
from teamformer.files.drawn.named_settings import new_tasks_of, spec_of, world_of
from teamformer.mission.parts.grid import Grid


@pytest.mark.parametrize(
    ("name", "spec"),
    [
        ("4N4T-C4", Spec(4, 4, 4)),
        ("8N20T-C8", Spec(8, 20, 8)),
        ("20N100T-C4", Spec(20, 100, 4, world=Grid(20, 20))),
        ("100N20T-C100-R90", Spec(100, 20, 100, requirements=90, world=Grid(20, 20))),
        ("4N20+20T-C4-tsp", Spec(4, 20, 4, late_tasks=20)),
        ("4N20+20T-C4-nn", Spec(4, 20, 4, late_tasks=20)),
        ("8N10T-C4-30x40", Spec(8, 10, 4, world=Grid(30, 40))),
    ],
)
def test_a_name_says_everything(name: str, spec: Spec) -> None:
    assert spec_of(name) == spec


@pytest.mark.parametrize("name", ["", "4N4T", "4N4T-C4-R", "N4T-C4", "4N4T-C4x", "4N4T-C4-nn-tsp"])
def test_other_names_are_refused(name: str) -> None:
    with pytest.raises(TeamformerError, match="is no setting"):
        spec_of(name)


def test_an_impossible_setting_is_refused() -> None:
    with pytest.raises(TeamformerError, match="requirements is 5"):
        spec_of("4N4T-C4-R5")
    with pytest.raises(TeamformerError, match="robots is 0"):
        spec_of("0N4T-C4")


def test_a_seed_is_a_world() -> None:
    assert world_of("4N4T-C4", 3) == world_of("4N4T-C4", 3)
    assert world_of("4N4T-C4", 3).tasks != world_of("4N4T-C4", 4).tasks


def test_late_tasks_follow_the_paper() -> None:
    tour, nearest = (world_of(f"4N20+20T-C4-{way}", 5) for way in ("tsp", "nn"))
    assert (tour.robots, tour.tasks) == (nearest.robots, nearest.tasks)
    played = [new_tasks_of(f"4N20+20T-C4-{way}") for way in ("tsp", "nn")]
    assert played == ["resolve", "nearest"]
    steps = set()
    for seed in range(200):
        appears = [task.appears for task in world_of("4N20+20T-C4-nn", seed).tasks]
        assert appears[:20] == [0] * 20
        assert len(set(appears[20:])) == 1
        steps.add(appears[20])
    assert steps == set(range(10, 26))
