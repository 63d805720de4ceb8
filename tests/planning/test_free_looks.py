"""Who has time to spare looks at what nobody has seen: by hand, and what it is worth."""

from __future__ import annotations

from collections.abc import Set
from dataclasses import replace

import pytest

from coordinations import method_of
from small_worlds import far_from_what_may_be_needed, make, robot, task
from teamformer.files.drawn.named_settings import world_of
from teamformer.mission.coordination import Known, Plan
from teamformer.mission.model import Mission
from teamformer.mission.truth import draw_truth, expected_mission
from teamformer.planning.steps.free_looks import with_free_looks
from teamformer.planning.steps.shared_plan import plan_mission
from teamformer.record.export.reasons import story_lines
from teamformer.record.files.reading import record_from_tree
from teamformer.record.files.writing import record_to_tree
from teamformer.record.record import Record
from teamformer.record.referee import judge
from teamformer.trials.trial import run_trial


def begin(
    mission: Mission, unseen_needs: Set[int] = frozenset(), unseen_places: Set[int] = frozenset()
) -> Known:
    """Return what everybody knows of a mission at its start."""
    return Known(
        mission=expected_mission(mission),
        now=0,
        open_tasks=tuple(range(len(mission.tasks))),
        places=tuple(robot.at for robot in mission.robots),
        teams=mission.starting_teams,
        free_at=(0,) * len(mission.robots),
        unseen_needs=frozenset(unseen_needs),
        unseen_places=frozenset(unseen_places),
    )


def play_where(mission: Mission, needs: str, foresight: str = "scouting") -> Record:
    """Play a mission whose first task turns out to need each letter of `needs`."""
    for seed in range(100):
        if draw_truth(mission, seed).tasks[0].needs.keys() == set(needs):
            return run_trial(mission, method_of("plan", foresight), seed).record
    raise AssertionError("no seed below 100 draws that")


@pytest.mark.parametrize(
    ("foresight", "needs", "makespan"),
    [
        ("needed", "ab", 22),  # at T after 5, one in the 6th, apart in the 7th, b 15 to V
        ("needed", "a", 20),  # a shows after 5 that b came in vain: 15 to V
        ("scouting", "ab", 22),
        (
            "scouting",
            "a",
            17,
        ),  # c shows it after 2, b is at V after 14, a at U after 9, for 8 steps
    ],
)
def test_a_scout_pays(foresight: str, needs: str, makespan: int) -> None:
    """b goes to T first: from V it would be there after 25 steps only. But c is near and idle."""
    record = play_where(far_from_what_may_be_needed(), needs, foresight)
    assert record.end.makespan == makespan
    assert judge(record).findings == ()
    assert [(made, (2, 0) in scouts) for made, scouts in record.scouts[:1]] == (
        [(0, True)] if foresight == "scouting" else []
    )


def test_it_is_said_why_a_scout_goes() -> None:
    record = play_where(far_from_what_may_be_needed(), "a")
    first = next(story_lines(record, 2))
    assert first == ("1-2", "walks to t0", "the plan has r2 look first at what is not known of it")


def test_the_referee_says_who_scouts_in_vain() -> None:
    record = play_where(far_from_what_may_be_needed(), "a")
    later = next(made for made, _ in record.plans if made > 0)
    for scouts, complaint in (
        ([[0, [[2, 0], [2, 0]]]], "scout twice"),
        ([[0, [[2, 0]]], [later, [[2, 0]]]], "of which all is known"),
        (
            [[0, [[2, 0]]], [later + 1, [[2, 0]]]],
            f"there are scouts of no plan made after {later + 1} steps",
        ),
    ):
        tree = record_to_tree(record) | {"scouts": scouts}
        found = judge(record_from_tree(tree, "forged")).findings
        assert any(complaint in str(finding) for finding in found)


def looks(start: int, hides_place: bool = False) -> tuple[tuple[int, int], ...]:
    """Return who scouts what where a has time until T begins in step `start`, b until U does.

    a . . . H . . . . . T . . . . . . . bU     H begins in step 40, T needs both
    0       4           10              18
    """
    tasks = [task("a", 4), task("ab", 10), task("b", 18)]
    mission = make([robot("a", 0), robot("b", 18)], tasks)
    plan = Plan((2, 1, 0), ((1,), (0, 1), (0,)), (0, start, 40))
    known = begin(mission, set() if hides_place else {0}, {0} if hides_place else set())
    return with_free_looks(known, plan).scouts


@pytest.mark.parametrize(
    ("start", "hides_place", "scouts"),
    [
        (12, False, ((0, 0),)),  # 4 steps to H, 6 to T, and two who meet there
        (11, False, ()),
        (17, True, ((0, 0),)),  # looking for it takes five more
        (16, True, ()),
    ],
)
def test_who_looks_is_in_time(
    start: int, hides_place: bool, scouts: tuple[tuple[int, int], ...]
) -> None:
    """b has to begin U at once."""
    assert looks(start, hides_place) == scouts


def test_nobody_looks_where_others_begin_before() -> None:
    """c is idle and 4 cells from T, which begins in step 7 or in step 6: three steps after."""
    tasks = [replace(task("a", 4), may_need={"b": 0.5})]
    mission = make([robot("a", 9), robot("b", 10), robot("c", 0)], tasks)
    for end, scouts in ((7, ((2, 0),)), (6, ())):
        plan = Plan((0,), ((0, 1),), (end,))
        seen = with_free_looks(begin(mission, {0}), plan)
        assert seen.scouts == scouts


def test_where_all_is_known_it_is_the_shared_plan() -> None:
    known = begin(world_of("4N20T-C4", 0))
    plan = plan_mission(known)
    assert with_free_looks(known, plan) is plan


def test_a_team_scouts_together() -> None:
    """Both c are idle and one team; with nothing to do it need not part."""
    tasks = [replace(task("a", 4), may_need={"b": 0.5})]
    robots = [robot("a", 9), robot("b", 10), robot("c", 0), robot("c", 0)]
    mission = make(robots, tasks, teams=((0,), (1,), (2, 3)))
    plan = Plan((0,), ((0, 1),), (7,))
    seen = with_free_looks(begin(mission, {0}), plan)
    assert seen.scouts == ((2, 0), (3, 0))


def test_a_task_is_looked_at_by_one_robot_and_a_robot_looks_at_one_task() -> None:
    mission = world_of("12N12T-C8-needs", 0)
    hidden = frozenset(number for number, one in enumerate(mission.tasks) if one.may_need)
    known = begin(mission, hidden)
    scouts = with_free_looks(known, plan_mission(known)).scouts
    assert len(scouts) == len(dict(scouts)) == len({scouted for _, scouted in scouts}) > 1
    assert {scouted for _, scouted in scouts} <= hidden
