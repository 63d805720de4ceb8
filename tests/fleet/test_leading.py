"""Policies in agents: what they see beside the simulator's views, and what becomes of it."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from fleets import PLANNER, pair, plan_of, trio
from own_policies import Alone
from teamformer.base.errors import TeamformerError
from teamformer.files.drawn.generate import Spec, generate
from teamformer.fleet.agent.knowledge import Knowledge, Remembered
from teamformer.fleet.agent.leading import PATIENCE, warm_up
from teamformer.fleet.agent.sight import Company, companies, view_of
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.messages import Word
from teamformer.fleet.methods import policy_of
from teamformer.fleet.rehearsal.checking.trace import Said, Trace, Worked
from teamformer.fleet.rehearsal.faults import Faults, draw_faults
from teamformer.fleet.rehearsal.play import Rehearsal
from teamformer.fleet.rehearsal.rehearse import play
from teamformer.methods.scripted.joining import JoinAll
from teamformer.world.env import Decision, TeamFormation
from teamformer.world.view import View

OWN = "own_policies:"


def test_a_robot_sees_what_the_simulator_shows_its_team() -> None:
    """All that is in sight is known: then both views of a team are the same in every array."""
    rng = np.random.default_rng(5)
    compared = 0
    for robots, tasks, radius in ((5, 7, 3.0), (8, 20, 2.0), (20, 6, 9.0)):
        mission = FleetMission(generate(Spec(robots, tasks, 3, sensing_radius=radius), rng))
        env, policy = TeamFormation([mission.source]), JoinAll()
        while env.is_running.any():
            view = env.view()
            teams = env.worlds.teams[0]
            slots = env.worlds.robots["team"][0].tolist()
            words = [
                Word(r, 1, *map(float, (teams["x"][t], teams["y"][t])), t, int(teams["task"][t]))
                for r, t in enumerate(slots)
            ]
            known = Knowledge(mission, 0, Remembered())
            undone = np.flatnonzero(env.worlds.tasks["is_open"][0])
            ranks = env.worlds.tasks["rank"][0]
            order = sorted(undone.tolist(), key=ranks.__getitem__)
            for row, slot in enumerate(view.slot.tolist()):
                own = Company(
                    slot,
                    tuple(r for r in range(robots) if slots[r] == slot),
                    (words[slot].x, words[slot].y),
                    words[slot].goal,
                    False,
                )
                near = [
                    w
                    for w in words
                    if w.team != slot
                    and (w.x - own.place[0]) ** 2 + (w.y - own.place[1]) ** 2 <= radius**2
                ]
                mine = view_of(known, own, companies(near), order)
                assert_row(mine, view, row)
                compared += 1
            env.step(policy.decide(view))
    assert compared > 200


def assert_row(mine: View, view: View, row: int) -> None:
    """Compare what one team sees with its row of the simulator's view."""
    begin, end = view.first_member[row : row + 2]
    for name in view._fields:
        one, other = getattr(mine, name), getattr(view, name)
        if name in ("member", "member_counts"):
            assert one.tolist() == other[begin:end].tolist(), name
        elif name != "first_member":
            assert one[0].tolist() == other[row].tolist(), name


@pytest.mark.parametrize("policy", ["Sociable", "Parting"])
def test_a_users_own_class_decides_with_whom_robots_stand(policy: str) -> None:
    """The pair meets at 6 and joins there: six steps, one for joining, two of service."""
    trace = Trace()
    _, outcome, violations = play(pair(), plan_of(pair()), Faults(), trace, OWN + policy)
    assert (outcome.status, violations) == ("ended", [])
    assert outcome.makespan is not None
    assert 9.0 <= outcome.makespan <= 9.6
    said = [event for event in trace.events if isinstance(event, Said) and event.phase > 1]
    assert {event.team for event in said} == {0}


def test_a_team_stays_together_until_its_policy_parts_it() -> None:
    """Tasks for a, bc, abc, c, ab in one row: who never parts walks to all of them as one."""
    teams: dict[str, set[int]] = {}
    spans: dict[str, float] = {}
    for policy in ("Sociable", "Parting"):
        trace = Trace()
        _, outcome, violations = play(trio(), plan_of(trio()), Faults(), trace, OWN + policy)
        assert (outcome.status, outcome.tasks_done, violations) == ("ended", 5, [])
        worked = [event for event in trace.events if isinstance(event, Worked)]
        teams[policy] = {event.team for event in worked if event.task == 3}
        spans[policy] = outcome.makespan or 0.0
    assert teams == {"Sociable": {0}, "Parting": {2}}  # c's task: with a and b, or alone
    assert 19 <= spans["Sociable"] <= 21  # from 5 to 2, 9, 15 and 12: nineteen steps


def test_where_a_policy_does_nothing_the_plan_does() -> None:
    """`ab` needs both, and they never want to join: after a while the plan makes them."""
    policies = {robot: Alone() for robot in range(2)}
    rehearsal = Rehearsal(
        pair(), PLANNER, plan_of(pair()), Faults(), make_policy=policies.__getitem__
    )
    outcome = rehearsal.run(300.0)
    assert outcome.status == "ended"
    assert outcome.makespan is not None
    assert PATIENCE < outcome.makespan < 2 * PATIENCE
    assert policies[0].asked > 10


@pytest.mark.parametrize("name", ["own_policies:Erratic", "own_policies:Parting", "join-fitting"])
def test_no_policy_breaks_a_promise_or_blocks_under_faults(name: str) -> None:
    for seed in range(4):
        faults = draw_faults(trio(), 40 + seed, 30.0)
        _, outcome, violations = play(trio(), plan_of(trio()), faults, method=name)
        assert violations == []
        assert outcome.status != "blocked"


@pytest.mark.slow
@pytest.mark.parametrize("name", ["Erratic", "Alone", "Sociable", "Parting"])
def test_no_policy_breaks_a_promise_or_blocks_under_many_faults(name: str) -> None:
    for seed in range(60):
        faults = draw_faults(trio(), 400 + seed, 30.0)
        _, outcome, violations = play(trio(), plan_of(trio()), faults, method=OWN + name)
        assert (violations, outcome.status == "blocked") == ([], False), seed


@pytest.mark.thorough
def test_the_learned_policy_decides_in_agents() -> None:
    """`teamformer` is asked with one team at a time, and the mission ends under losses too."""
    make = partial(policy_of, "teamformer")
    for faults in (Faults(), Faults(seed=2, loss=0.5)):
        rehearsal = Rehearsal(trio(), PLANNER, plan_of(trio()), faults, make_policy=make)
        outcome = rehearsal.run(400.0)
        assert (outcome.status, outcome.tasks_done) == ("ended", 5)


def test_a_policy_is_warmed_up_by_one_question_about_the_robot_alone_at_a_task() -> None:
    seen: list[View] = []

    class Noting(Alone):
        def decide(self, view: View) -> Decision:
            seen.append(view)
            return super().decide(view)

    policy = Noting()
    warm_up(policy, pair(), 1)
    assert policy.asked == 1
    assert seen[0].slot.tolist() == [1]
    assert seen[0].member.tolist() == [1]
    assert seen[0].place.tolist() == [[6, 0]]  # where `ab` is
    assert seen[0].is_at_task.tolist() == [True]


def test_who_must_know_everything_is_refused() -> None:
    with pytest.raises(TeamformerError, match="no robot does"):
        policy_of("central", 0)
