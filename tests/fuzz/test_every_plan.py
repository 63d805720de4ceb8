"""Plans with optional tasks, shifts, batteries or zones, beside every plan of small missions."""

from __future__ import annotations

import pytest

from every_plan import DRAWN, best_worth, worth_by


@pytest.mark.parametrize("kind", DRAWN)
def test_no_plan_of_a_small_mission_is_better(kind: str) -> None:
    for number in range(3):
        mission = DRAWN[kind](number)
        assert worth_by(mission, "plan", 0) == pytest.approx(best_worth(mission), rel=1e-5)
