"""Missions whose counts are fractions: played as those in whole numbers are, told as written."""

from __future__ import annotations

import itertools
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from teamformer.base.errors import MissionError, TeamformerError
from teamformer.files.drawn.generate import Spec, generate
from teamformer.files.mission_files import read_mission
from teamformer.fleet.agent.planning import first_plan
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.messages import EVERYBODY, OPERATOR, Notice, Offer, Post, TaskFact
from teamformer.fleet.planner import CoordinatedPlanner
from teamformer.fleet.rehearsal.faults import Faults, Order
from teamformer.fleet.rehearsal.rehearse import play as rehearse
from teamformer.live.running.incidents import NewTask
from teamformer.live.running.messages import read_incident
from teamformer.live.steps.mission_with_past import RunningMission
from teamformer.methods.by_name import load_method
from teamformer.methods.scripted.joining import JoinAll
from teamformer.mission.model import Arrivals, Mission, Robot, Task
from teamformer.mission.parts.capabilities import Counts
from teamformer.mission.parts.grid import Grid
from teamformer.mission.parts.plane import Plane
from teamformer.planning.bounds.makespan import lower_bound
from teamformer.planning.continuous.continuous_mission import pose_mission
from teamformer.planning.problem.relaxed_problem import most_in_coalitions, relax
from teamformer.record.export.csv_tables import write_tables
from teamformer.record.export.reasons import explain
from teamformer.record.referee import judge
from teamformer.robotarium.mission_checks import check_mission
from teamformer.trials.trial import run_trial
from teamformer.world.env import TeamFormation
from teamformer.world.multi_agent.parallel_env import TeamFormationParallel

EXAMPLE = Path(__file__).parents[1] / "examples" / "piano.yaml"


def haul(*robots: float, needs: float = 100, **rules: Any) -> Mission:
    """Return robots in one place that lift so many kilograms, and a task three cells away."""
    fleet = tuple(Robot(f"r{n}", (0, 0), {"lift": can}) for n, can in enumerate(robots))
    safe = Task("safe", (3, 0), {"lift": needs})
    return Mission("haul", Grid(8, 1), ("lift",), fleet, (safe,), **rules)


def scaled(mission: Mission, factors: dict[str, float]) -> Mission:
    """Return a mission with all counts multiplied, by capability."""

    def times(counts: Counts) -> Counts:
        return {cap: count * factors[cap] for cap, count in counts.items()}

    robots = tuple(replace(robot, can=times(robot.can)) for robot in mission.robots)
    tasks = tuple(replace(task, needs=times(task.needs)) for task in mission.tasks)
    return replace(mission, robots=robots, tasks=tasks)


def pair_of_worlds() -> tuple[Mission, Mission]:
    """Return a mission in ones and twos, and the same in kilograms, litres and grams."""
    drawn = generate(Spec(5, 8, 3), np.random.default_rng(4))
    tasks = tuple(
        replace(task, needs={**task.needs, "c1": 2}) if number % 3 == 0 else task
        for number, task in enumerate(drawn.tasks)
    )
    strong = replace(drawn.robots[0], can={"c1": 2, "c2": 1})
    whole = replace(drawn, robots=(strong, *drawn.robots[1:]), tasks=tasks)
    return whole, scaled(whole, {"c1": 0.5, "c2": 12.345, "c3": 0.125})


PLAYED = (
    *("join-all", "heuristic", "join-fitting", "crews", "plan"),
    *("teamformer", "teamformer-c4", "gnn-c4"),
)


@pytest.mark.parametrize("name", PLAYED)
def test_scaled_counts_are_played_alike(name: str) -> None:
    whole, parts = pair_of_worlds()
    one, other = (run_trial(mission, load_method(name)).record for mission in (whole, parts))
    assert one.end.status == "completed"
    assert (one.steps, one.orders, one.plans, one.end) == (
        *(other.steps, other.orders, other.plans, other.end),
    )
    assert judge(other).findings == ()


def test_scaled_counts_are_planned_alike() -> None:
    whole, parts = pair_of_worlds()
    assert lower_bound(whole) == lower_bound(parts)
    posed = (pose_mission(replace(s, time="continuous", step_limit=0)) for s in (whole, parts))
    for one, other in itertools.pairwise(mission.problem for mission in posed):
        assert np.array_equal(one.counts, other.counts)
        assert np.array_equal(one.needs, other.needs)


def test_no_more_robots_than_this_are_needed_whatever_each_brings() -> None:
    """Three of 12.5 lift 30.1, and two of 20.25; there are no three robots where there are two."""
    problem = relax(haul(12.5, 20.25, 12.5, 12.5, needs=30.1))
    assert (problem.counts[:, 0].tolist(), problem.needs.tolist()) == ([50, 81, 50, 50], [[121]])
    assert most_in_coalitions(problem).tolist() == [3]
    assert most_in_coalitions(relax(haul(12.5, 20.25, needs=30.1))).tolist() == [2]


def test_three_robots_of_33_333_do_not_lift_100() -> None:
    with pytest.raises(MissionError, match=r"needs 100 x lift but .* have 99\.999 x lift"):
        haul(33.333, 33.333, 33.333)
    record = run_trial(haul(33.334, 33.334, 33.334), JoinAll()).record
    assert record.steps[-1].done == ((0, 0),)
    assert sum(len(step.joins) for step in record.steps) == 2
    assert judge(record).findings == ()


def test_two_wait_for_the_gram_that_they_lack() -> None:
    """20.25 and 12.5 join, and stand there in step 4; the third takes 8 steps, and one to join."""
    mission = haul(20.25, 12.5, 0.001, needs=32.751)
    slow = replace(mission.robots[2], at=(7, 0), speed=0.5)
    mission = replace(mission, robots=(*mission.robots[:2], slow), step_limit=0)
    record = run_trial(mission, load_method("join-fitting")).record
    assert judge(record).findings == ()
    assert record.end.makespan == 9
    assert "lacks 0.001 x lift, which r2 brings" in [chapter.why for chapter in explain(record, 0)]


def test_views_count_in_units() -> None:
    env = TeamFormation([haul(12.5, 20.25, needs=30.1)])
    view = env.view()
    assert view.counts.tolist() == [[50], [81]]
    assert view.task_needs[0].tolist() == [[121]]  # 30.25, of which 30.1 are needed
    assert env.missions[0].out_of_units({"lift": 81}) == {"lift": 20.25}


def test_a_whole_one_more_may_be_needed_of_fractions() -> None:
    """One more of 20.25 is 21.25: it is believed where it can be brought, 85 x 0.25."""
    task = Task("safe", (3, 0), {"lift": 20.25}, may_need={"lift": 0.5})
    with pytest.raises(MissionError, match=r"may need 21\.25 x lift but .* lack 0\.25 x lift"):
        replace(haul(20.5, 0.5, needs=1), tasks=(task,))
    mission = replace(haul(20.5, 0.75, needs=1), tasks=(task,))
    assert TeamFormation([mission]).view().task_needs[0, 0].tolist() == [85]
    assert TeamFormation([mission], foresight="absent").view().task_needs[0, 0].tolist() == [81]


def test_what_appears_at_random_needs_a_whole_one() -> None:
    calls = Arrivals(0.5, 20)
    with pytest.raises(MissionError, match=r"bring 0\.75 x lift; add such a robot"):
        haul(0.5, 0.25, needs=0.5, arrivals=calls)
    mission = haul(0.5, 0.5, needs=0.5, arrivals=calls)
    record = run_trial(mission, JoinAll()).record
    assert record.end.status == "completed"
    assert judge(record).findings == ()


def test_the_example_is_played_by_every_kind_of_policy(tmp_path: Path) -> None:
    """The grand piano takes all four dollies: three and the crawler lift 0.45 too little."""
    mission = read_mission(EXAMPLE)
    for policy in ("heuristic", "plan", "teamformer", "deepset-c4"):
        record = run_trial(mission, load_method(policy)).record
        assert record.end.status == "completed"
        assert judge(record).findings == ()
    write_tables(record, tmp_path)
    assert "308.2 x lift, steer" in (tmp_path / "tasks.csv").read_text()
    assert "62.5 x lift" in (tmp_path / "robots.csv").read_text()


def test_a_network_that_spells_refuses_counts_that_take_too_long() -> None:
    mission = haul(12.5, 7.5, needs=15)  # 5 and 3 units of 2.5
    policy = load_method("teamformer-c4").policy
    assert run_trial(mission, policy).record.end.status == "completed"
    with pytest.raises(TeamformerError, match="spells counts one by one, and a robot brings 12,34"):
        run_trial(haul(12.345, 7.501, needs=15), policy)


def test_what_learners_are_given_lies_in_its_space() -> None:
    env = TeamFormationParallel(haul(12.345, 7.501, needs=15))
    seen, _ = env.reset(seed=0)
    for agent in env.agents:
        assert env.observation_space(agent).contains(seen[agent])
        assert env.action_space(agent).contains(seen[agent]["counts"])


def test_an_operators_task_may_be_finer_than_what_robots_bring() -> None:
    """7.401 of 2.5 kilograms take three robots, and are told as they were written."""
    run = RunningMission(haul(2.5, 2.5, 2.5, needs=2.5), lambda: load_method("join-all"), 0)
    run.step()
    message = {"task": {"at": [5, 0], "needs": {"lift": 7.401}, "name": "more"}}
    more = read_incident(message, run.source)
    assert more == NewTask(Task("more", (5, 0), {"lift": 7.401}))
    assert more.text(run.source) == "task more at [5, 0] that needs 7.401 x lift"
    run.happen(more)
    while run.is_running:
        run.step()
    assert run.record().mission.tasks[-1].needs == {"lift": 7.401}
    assert judge(run.record()).findings == ()
    again = run_trial(run.source, JoinAll()).record
    assert again.steps == run.record().steps
    with pytest.raises(TeamformerError, match=r"7\.501 x lift but .* have 7\.5 x lift"):
        run.happen(NewTask(Task("most", (5, 0), {"lift": 7.501})))


def test_a_fleet_does_what_an_operator_adds_in_fractions() -> None:
    mission = FleetMission(haul(2.5, 2.5, 2.5, needs=4.999))
    extra = TaskFact(9 << 24, "extra", 6.0, 0.0, (7.401,))
    assert mission.covers([0, 1, 2], extra.needs)
    assert not mission.covers([0, 1], (5.001,))
    faults = Faults(orders=(Order(1.0, extra),))
    _, outcome, violations = rehearse(mission, first_plan(mission, CoordinatedPlanner()), faults)
    assert (outcome.status, violations) == ("ended", [])
    assert mission.tasks[0].needs == (4.999,)


@pytest.mark.parametrize("count", [1.0005, float("nan"), float("inf"), -0.5, 100_000.5])
def test_a_message_with_a_senseless_count_is_dropped(count: float) -> None:
    post = Post(5, 2)
    for needs, is_good in (((12.5, 2), True), ((12.5, count), False)):
        offer = Offer(TaskFact(9 << 24, "extra", 1.0, 0.0, needs))
        message = post.open(post.seal(OPERATOR, Notice(EVERYBODY, offer)))
        assert (message is not None) == is_good


def test_robots_in_a_ring_are_no_fractions() -> None:
    mission = replace(haul(12.5, needs=12), world=Plane(3.2, 2.0), step_limit=0)
    with pytest.raises(MissionError) as caught:
        check_mission(mission)
    assert [problem.message for problem in caught.value.problems] == [
        "robot 'r0' can 12.5 x lift; use whole numbers here"
    ]
