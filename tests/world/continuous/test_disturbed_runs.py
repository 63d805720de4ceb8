"""Whatever is planned and happens: a mission comes to an end, and its log keeps promises."""

from __future__ import annotations

from contextlib import suppress

import pytest

from clock_missions import RandomPlans, draw_mission
from clock_promises import check_promises
from teamformer.base.errors import TeamformerError
from teamformer.methods.by_name import Method
from teamformer.methods.central.policy import Central
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.mission.coordination import Coordinator
from teamformer.mission.truth import draw_truth
from teamformer.record.referee import judge
from teamformer.trials.trial import run_trial
from teamformer.world.continuous.course import Course

MOST_MOMENTS = 10_000
SEEDS_EACH = 25


def run(seed: int, coordinator: Coordinator) -> Course:
    """Run a drawn mission to its end, and check its log."""
    mission = draw_mission(seed)
    truth = draw_truth(mission, seed)
    course = Course(mission, truth, coordinator)
    course.begin()
    for _ in range(MOST_MOMENTS):
        if not course.is_running:
            break
        course.go_on()
    assert course.status in ("completed", "infeasible")
    assert bool(course.blocked) == (course.status == "infeasible")
    check_promises(course.mission, truth, course.world.events)
    return course


@pytest.mark.parametrize("first", range(0, 8 * SEEDS_EACH, SEEDS_EACH))
def test_plans_at_random_come_to_an_end(first: int) -> None:
    for seed in range(first, first + SEEDS_EACH):
        run(seed, RandomPlans(seed))


@pytest.mark.parametrize("seed", range(12))
def test_the_shared_plan_comes_to_an_end(seed: int) -> None:
    with suppress(TeamformerError):  # linked tasks without enough robots, which no check foresees
        run(seed, SharedPlan())


@pytest.mark.parametrize("first", range(300, 400, SEEDS_EACH))
def test_the_referee_finds_records_of_plans_at_random_legal(first: int) -> None:
    for seed in range(first, first + SEEDS_EACH):
        record = run_trial(draw_mission(seed), RandomPlans(seed), seed).record
        assert judge(record).findings == (), f"seed {seed}"


@pytest.mark.parametrize(("seed", "status"), [(10219, "completed"), (10416, "infeasible")])
def test_what_nobody_tells_is_legal(seed: int, status: str) -> None:
    """A plan after a link has held a team in vain; an end while a lost robot lies on its way."""
    record = run_trial(draw_mission(seed), RandomPlans(seed), seed).record
    assert record.end.status == status
    assert judge(record).findings == ()


@pytest.mark.parametrize("seed", [10219, 10268, 10309, 10416])
def test_the_referee_knows_that_the_central_planner_is_told_the_truth(seed: int) -> None:
    """Where tasks are, what they need, how long they take; nothing bounds what is called off."""
    central = Method("central", Central(0.1, workers=1))
    record = run_trial(draw_mission(seed), central, seed).record
    assert judge(record).findings == ()


@pytest.mark.parametrize("seed", [1, 4, 7])
def test_a_fork_goes_on_as_the_world_does(seed: int) -> None:
    mission = draw_mission(seed)
    course = Course(mission, draw_truth(mission, seed), RandomPlans(seed))
    course.begin()
    for _ in range(10):
        if course.is_running:
            course.go_on()
    twin, past = course.fork(), len(course.world.events)
    while twin.is_running:
        twin.go_on()
    assert len(course.world.events) == past
    while course.is_running:
        course.go_on()
    assert course.world.events == twin.world.events
