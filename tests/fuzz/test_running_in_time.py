"""Missions in continuous time come to an end, keep promises, and are legal for the referee."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import strategies as st

from charged_keys import FORESEEN, KEYS, check_foreseen, drawn_with
from charging_missions import charged_mission
from clock_missions import RandomPlans, draw_mission
from clock_promises import check_promises
from missions import continuous_missions, optional_missions
from teamformer.base.errors import TeamformerError
from teamformer.files.drawn.continuous_incidents import INCIDENTS
from teamformer.files.drawn.continuous_missions import CONTINUOUS_FAMILIES
from teamformer.files.drawn.named_settings import world_of
from teamformer.files.mission_files import mission_from_tree, mission_to_tree
from teamformer.methods.by_name import load_method
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.mission.truth import draw_truth
from teamformer.planning.continuous.continuous_mission import pose_mission
from teamformer.planning.continuous.rules import plan_continuous
from teamformer.record.referee import judge
from teamformer.trials.trial import bound_of, run_trial
from watching import fuzzed

NEAR = 1e-9
FAMILIES = [
    name if incident is None else f"{name}-{incident}"
    for name in CONTINUOUS_FAMILIES
    for incident in (None, *INCIDENTS)
]
RUN = "run FILE --seed {seed}"
SEEDS = st.integers(0, 10**6)
"""Of what happens, and of plans at random."""

CHARGED_WITH, CHARGED_DISTURBED = (
    st.builds(
        lambda keys, seed: mission_to_tree(drawn_with(" ".join(keys), seed)),
        st.lists(st.sampled_from(keys), min_size=1, max_size=3, unique=True),
        SEEDS,
    )
    for keys in (FORESEEN, tuple(KEYS))
)
"""Missions with batteries and other keys: nothing unforeseen happens, or all may."""

CHARGED = SEEDS.map(lambda seed: mission_to_tree(charged_mission(seed)))
DRAWN = SEEDS.map(lambda seed: mission_to_tree(draw_mission(seed)))


@fuzzed(25, "run FILE", mission=continuous_missions())
def test_a_run_takes_as_long_as_its_plan(mission: Any) -> None:
    source = mission_from_tree(mission)
    try:
        made = plan_continuous(pose_mission(source), "plan", 0)
        record = run_trial(source, SharedPlan()).record
    except TeamformerError:  # linked tasks without enough robots, which no check foresees
        return
    assert made is not None
    if all(task.appears == 0 for task in source.tasks):
        assert record.end.makespan == pytest.approx(made.makespan, rel=NEAR, abs=NEAR)
        assert record.end.broken_links == ()
    check_promises(source, record.true_mission, record.events)


@fuzzed(10, "run FILE", mission=CHARGED)
def test_robots_that_charge_take_as_long_as_their_plan(mission: Any) -> None:
    source = mission_from_tree(mission)
    made = plan_continuous(pose_mission(source), "plan", 0)
    record = run_trial(source, SharedPlan()).record
    assert made is not None
    assert record.end.makespan == pytest.approx(made.makespan, rel=NEAR, abs=NEAR)
    assert judge(record).findings == ()


@fuzzed(8, "run FILE", mission=CHARGED_WITH)
def test_robots_that_charge_keep_to_their_plan_whatever_else_there_is(mission: Any) -> None:
    try:
        record = run_trial(mission_from_tree(mission), SharedPlan()).record
    except TeamformerError:  # linked tasks without enough robots in reach, which no check foresees
        return
    assert judge(record).findings == ()
    check_foreseen(record)


@fuzzed(8, RUN, mission=CHARGED_DISTURBED, seed=SEEDS)
def test_robots_that_charge_are_legal_whatever_happens(mission: Any, seed: int) -> None:
    record = run_trial(mission_from_tree(mission), SharedPlan(), seed).record
    assert record.end.status in ("completed", "infeasible", "too late")
    assert judge(record).findings == ()


@fuzzed(25, "run FILE", mission=optional_missions())
def test_a_run_misses_what_its_plan_leaves_out(mission: Any) -> None:
    source = mission_from_tree(mission)
    try:
        made = plan_continuous(pose_mission(source), "plan", 0)
        record = run_trial(source, SharedPlan()).record
    except TeamformerError:  # linked tasks without enough robots, which no check foresees
        return
    assert made is not None
    assert record.end.status in ("completed", "too late")
    assert judge(record).findings == ()
    if record.end.status == "completed" and all(task.appears == 0 for task in source.tasks):
        assert record.end.makespan == pytest.approx(made.makespan, rel=NEAR, abs=NEAR)
        assert record.end.missed == tuple(source.tasks[task].name for task in made.missed)


@fuzzed(40, RUN, mission=DRAWN, seed=SEEDS)
def test_plans_at_random_come_to_an_end_and_are_legal(mission: Any, seed: int) -> None:
    source = mission_from_tree(mission)
    record = run_trial(source, RandomPlans(seed), seed).record
    assert record.end.status in ("completed", "infeasible")
    check_promises(record.mission, record.true_mission, record.events)
    if record.end.status == "completed":
        assert judge(record).findings == ()


@fuzzed(
    8, "run FILE --method {method} --seed {seed}",
    mission=st.builds(world_of, st.sampled_from(FAMILIES), SEEDS).map(mission_to_tree),
    method=st.sampled_from(["soonest", "reactive", "plan"]),
    seed=SEEDS,
)  # fmt: skip
def test_families_run_to_their_end_whatever_happens(mission: Any, method: str, seed: int) -> None:
    source = mission_from_tree(mission)
    bound = bound_of(draw_truth(source, seed))
    record = run_trial(source, load_method(method), seed, bound).record
    ends = ("completed", "completed" if source.until is None else "too late")
    assert record.end.status in ends
    assert judge(record).findings == ()  # the bound is one, too
    check_promises(record.mission, record.true_mission, record.events)
