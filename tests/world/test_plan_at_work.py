"""The shared plan while a trial runs: it is played as planned, and made anew at events."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from coordinations import play_by_plan
from teamformer.files.drawn.generate import Spec, generate
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.mission.model import Absence, Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.planning.steps.shared_plan import plan_mission
from teamformer.record.referee.judge import judge
from teamformer.trials.trial import run_trial
from teamformer.world.env import TeamFormation

CAPS = ("lift", "weld")


def corridor(tasks: list[Task], *robots: Robot) -> Mission:
    return Mission("corridor", Grid(30, 1), CAPS, robots, tuple(tasks))


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.thorough
def test_what_is_planned_is_what_happens(seed: int) -> None:
    rng = np.random.default_rng(seed)
    mission = generate(Spec(robots=6, tasks=8, capabilities=4), rng)
    env = TeamFormation([mission], coordinator=SharedPlan())
    planned = plan_mission(env.known())
    play_by_plan(env)
    assert env.tally().status == "completed"
    assert env.tally().steps == planned.makespan
    done = env.worlds.tasks["done_at"][0]
    assert [int(done[task]) for task in planned.order] == list(planned.ends)


def test_the_record_says_why_plans_are_made_and_the_referee_goes_by_them() -> None:
    ann, bob = (
        Robot("ann", (0, 0), {"lift": 1}),
        Robot("bob", (2, 0), {"lift": 1}, absences=(Absence(8),)),
    )
    tasks = [
        Task("a", (6, 0), {"lift": 1}),
        Task("b", (20, 0), {"lift": 1}),
        Task("c", (1, 0), {"lift": 1}, appears=5),
    ]
    record = run_trial(corridor(tasks, ann, bob), SharedPlan()).record
    assert record.end.status == "completed"
    assert [(steps, plan.reasons) for steps, plan in record.plans] == [
        (0, ("start",)),
        (5, ("task appeared",)),
        (8, ("robot lost",)),
    ]
    assert judge(record).findings == ()
    steps, last = record.plans[-1]
    forged = last._replace(coalitions=((1,), *last.coalitions[1:]))
    found = judge(replace(record, plans=(*record.plans[:-1], (steps, forged)))).findings
    assert any("lost" in finding.message for finding in found)


def test_whoever_is_not_needed_stays_behind() -> None:
    ann = Robot("ann", (0, 0), {"lift": 1}, speed=0.5)
    bob = Robot("bob", (0, 0), {"weld": 1})
    tasks = [Task("both", (0, 0), {"lift": 1, "weld": 1}), Task("far", (20, 0), {"weld": 1})]
    env = TeamFormation([corridor(tasks, ann, bob)], coordinator=SharedPlan())
    play_by_plan(env)
    assert env.tally().steps == 1 + 1 + 20  # a join, a split, and the way at bob's own pace
    assert env.worlds.teams["x"][0].tolist() == [0.0, 20.0]


def test_like_robots_take_each_others_part() -> None:
    """The rules let the lower of two like robots stay, whichever the plan means to."""
    robots = [Robot(f"r{n}", (10, 0), {"lift": 1}) for n in range(2)]
    tasks = [
        Task("both", (10, 0), {"lift": 2}),
        *(Task(f"t{x}", (x, 0), {"lift": 1}) for x in (0, 20)),
    ]
    env = TeamFormation([corridor(tasks, *robots)], coordinator=SharedPlan())
    play_by_plan(env)
    assert env.tally().steps == 1 + 1 + 10
    assert env.tally().illegal_decisions == 0


def test_forks_and_resets_keep_the_plan() -> None:
    rng = np.random.default_rng(3)
    missions = [generate(Spec(robots=6, tasks=6, late_tasks=2), rng) for _ in range(4)]
    env = TeamFormation(missions, threads=2, coordinator=SharedPlan())
    for _ in range(5):
        env.step(env.planned_decision(env.view()))
    twin = env.fork()

    def play(which: TeamFormation) -> list[object]:
        while which.is_running.any():
            which.step(which.planned_decision(which.view()))
        return [which.tally(w) for w in range(4)]

    ended = play(env)
    assert play(twin) == ended
    env.reset()
    assert play(env) == ended
    env.close()


def test_plans_are_the_same_with_one_thread_and_two() -> None:
    rng = np.random.default_rng(11)
    spec = Spec(robots=6, tasks=7, late_tasks=3, capabilities=3, late_between=(2, 6))
    missions = [generate(spec, rng) for _ in range(6)]
    played = []
    for threads in (1, 2):
        with TeamFormation(missions, threads=threads, coordinator=SharedPlan()) as env:
            plans = []
            while env.is_running.any():
                env.step(env.planned_decision(env.view()))
                plans.append([env.plan(w) for w in range(len(missions))])
            played.append((plans, [env.tally(w) for w in range(len(missions))]))
    assert played[0] == played[1]
