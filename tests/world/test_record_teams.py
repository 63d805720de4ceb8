"""Records unrolled: who is together after each step, against teams written down by hand."""

from __future__ import annotations

import pytest

from small_worlds import make, robot, task
from teamformer.methods.by_name import load_method
from teamformer.record.record import Ending, Record, Step, TeamAt
from teamformer.record.teams import Teams, completions
from teamformer.trials.routes import routes_of
from teamformer.trials.trial import run_trial
from teamformer.world.rules.constants import NOBODY

START = ((0, (0, 2, 3), 0, 0), (1, (1,), 2, 0))
"""Three robots together, and one two cells away."""


def record_of(*steps: Step) -> Record:
    """A record of four robots that lift and a box; only its teams mean anything."""
    mission = make([robot("a", 0), robot("a", 2), robot("a", 0), robot("a", 0)], [task("a", 2)])
    end = Ending("interrupted", None, len(steps), 0, 0, 0, 0)
    return Record(mission, "by hand", 0, ((0, (0,)),), START, steps, end=end)


def after(*steps: Step) -> Teams:
    """The teams after some steps."""
    record = record_of(*steps)
    teams = Teams(record.mission.robots, record.start)
    for step in record.steps:
        teams.follow(step)
    return teams


def test_a_record_begins_with_its_starting_teams() -> None:
    teams = after()
    assert teams.robots == {0: (0, 2, 3), 1: (1,)}
    assert teams.slot == [0, 1, 0, 0]
    assert [teams.place(robot) for robot in range(4)] == [(0, 0), (2, 0), (0, 0), (0, 0)]
    assert teams.task == {0: NOBODY, 1: NOBODY}


def test_who_stays_without_the_lowest_robot_gets_another_slot_and_no_task() -> None:
    heading = Step(teams=(TeamAt(0, 0, 0, 0),))
    teams = after(heading, Step(splits=(((2, 3), (0,)),)))
    assert teams.robots == {0: (0,), 1: (1,), 2: (2, 3)}
    assert teams.task == {0: 0, 1: NOBODY, 2: NOBODY}
    assert teams.at[2] == (0, 0)


def test_a_join_has_the_lower_slot_with_its_place_and_task() -> None:
    teams = after(Step(teams=(TeamAt(0, 1, 0, 0),)), Step(joins=((1, 0),)))
    assert teams.robots == {0: (0, 1, 2, 3)}
    assert teams.at == {0: (1, 0)}
    assert teams.task == {0: 0}


def test_steps_say_who_was_split_or_joined() -> None:
    teams = Teams(record_of().mission.robots, START)
    assert teams.follow(Step(splits=(((0,), (2, 3)),))) == {0, 2, 3}
    assert teams.follow(Step(joins=((2, 1),))) == {1, 2, 3}
    assert teams.follow(Step()) == set()


def test_a_lost_lowest_robot_leaves_its_place_and_task_to_the_next() -> None:
    teams = after(Step(teams=(TeamAt(0, 1, 0, 0),)), Step(lost=(0, 3)))
    assert teams.slot == [NOBODY, 1, 2, NOBODY]
    assert teams.robots == {1: (1,), 2: (2,)}
    assert (teams.at[2], teams.task[2]) == ((1, 0), 0)
    assert teams.place(0) == (1, 0)


def test_a_robot_is_back_alone_where_it_was_lost() -> None:
    moved = Step(teams=(TeamAt(2, 3, 0, None),))
    teams = after(Step(lost=(0,)), moved, Step(back=(0,)))
    assert teams.robots == {0: (0,), 1: (1,), 2: (2, 3)}
    assert (teams.at[0], teams.at[2]) == ((0, 0), (3, 0))


def test_tasks_are_done_by_the_team_that_is_there_at_the_end_of_the_step() -> None:
    joined = Step(joins=((1, 0),), lost=(2,), done=((0, 0),))
    assert list(completions(record_of(Step(), joined))) == [(2, 0, (0, 1, 3))]


@pytest.mark.parametrize("method", ["plan", "join-all"])
def test_routes_stop_where_tasks_were_done(method: str) -> None:
    tasks = [task("aa", 3, duration=2), task("a", 5)]
    mission = make([robot("a", 0), robot("a", 5), robot("a", 9, lost=2)], tasks)
    record = run_trial(mission, load_method(method, 1.0), 0).record
    stops = [
        (stop.end, stop.task, route.robot) for route in routes_of(record) for stop in route.stops
    ]
    done = [(step, task, robot) for step, task, robots in completions(record) for robot in robots]
    assert record.end.status == "completed"
    assert sorted(stops) == sorted(done)
