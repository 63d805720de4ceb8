"""Zones in missions in steps: by hand, and kernels beside plain rules."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from coordinations import RandomPlans
from random_worlds import (
    random_decision,
    random_world,
    with_batteries,
    with_docks,
    with_loads,
    with_optional,
    with_precedence_and_windows,
    with_shifts,
    with_surprises,
    with_zones,
)
from small_worlds import make, play, robot, task
from teamformer.base.errors import MissionError
from teamformer.methods.by_name import Player
from teamformer.methods.coordinators.crews import Crews
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.methods.scripted.heuristic import Heuristic
from teamformer.methods.scripted.joining import JoinAll
from teamformer.mission.coordination import Known, Plan
from teamformer.mission.model import Absence, Mission, Task
from teamformer.mission.parts.zones import AtWork, Zone, all_rooms_of
from teamformer.mission.truth import draw_truth
from teamformer.record.files.reading import record_from_tree
from teamformer.record.files.writing import record_to_tree
from teamformer.record.record import Record
from teamformer.record.referee.judge import judge
from teamformer.record.telling.whole import told_of
from teamformer.record.told.told_record import ToldRecord
from teamformer.trials.trial import run_trial
from teamformer.world.env import TeamFormation
from teamformer.world.reference.state import PlainWorld
from twins import Twin

KINDS = (
    *("sure", "unsure", "after", "optional", "shifts", "batteries"),
    *("loads", "loads, optional", "loads, shifts", "loads, batteries"),
)
"""What missions have besides zones."""

METHODS: dict[str, Player] = {
    "plan": SharedPlan(),
    "crews": Crews(),
    "join-all": JoinAll(),
    "heuristic": Heuristic(),
    "random plans": RandomPlans(5),
}


class Given:
    """Gives tasks to a robot each, in an order, at the start only."""

    heeds = ()

    def __init__(self, *rows: tuple[int, int]) -> None:
        self._rows = rows

    def update(self, known: Known, plan: Plan | None) -> Plan:
        """Return the rows, each of a task and its robot."""
        return Plan(tuple(k for k, _ in self._rows), tuple((r,) for _, r in self._rows))


def dock(*tasks: int, room: int = 1, durations: tuple[int, ...] = (3, 3, 3)) -> Mission:
    """Return three robots, each some cells from a task of its own; tasks `tasks` are in a zone.

    . a T a . U . a . V        robots at 1, 3 and 7, tasks at 2, 5 and 9
    """
    places = (2, 5, 9)
    wanted = [task("a", x, duration=d) for x, d in zip(places, durations, strict=True)]
    mission = make([robot("a", x) for x in (1, 3, 7)], wanted)
    names = tuple(mission.tasks[k].name for k in tasks)
    return replace(mission, zones=(Zone("dock", tasks=names, room=room),))


def ends(mission: Mission, *rows: tuple[int, int]) -> list[int]:
    """Return when tasks are done, by number, if robots do them in such an order."""
    env = TeamFormation([mission], coordinator=Given(*rows))
    while env.is_running[0]:
        env.step(env.planned_decision(env.view()))
    return env.worlds.tasks["done_at"][0].tolist()


IN_TURN = ((0, 0), (1, 1), (2, 2))


@pytest.mark.parametrize(
    ("tasks", "room", "rows", "ends_at"),
    [
        ((), 1, IN_TURN, [4, 5, 5]),  # each walks 1, 2 and 2 cells, and serves 3 steps
        ((0, 1, 2), 1, IN_TURN, [4, 7, 10]),  # one begins as the one before ends
        ((0, 1, 2), 2, IN_TURN, [4, 5, 7]),
        ((0, 2), 1, IN_TURN, [4, 5, 7]),
        ((0, 1, 2), 1, IN_TURN[::-1], [11, 8, 5]),  # who is there first waits for its turn
        ((0, 1, 2), 2, IN_TURN[::-1], [8, 5, 5]),
        ((0, 1), 3, IN_TURN, [4, 5, 5]),
    ],
)
def test_services_wait_for_room_in_the_order_of_the_plan(
    tasks: tuple[int, ...], room: int, rows: tuple[tuple[int, int], ...], ends_at: list[int]
) -> None:
    mission = dock(*tasks, room=room) if tasks else replace(dock(0), zones=())
    assert ends(mission, *rows) == ends_at


def test_who_is_later_goes_first_where_room_is_left_for_who_is_before() -> None:
    """Task 2 takes one of two rooms at step 2, though task 0 is before it, which is begun later."""
    mission = dock(0, 1, 2, room=2, durations=(9, 3, 3))
    far = replace(mission, tasks=(replace(mission.tasks[0], at=(19, 0)), *mission.tasks[1:]))
    assert ends(far, (0, 0), (2, 2), (1, 1)) == [18 + 9, 8, 5]


def test_all_rooms_are_taken_at_once_or_none() -> None:
    """Task 1 is in both zones: it waits for both, and task 2 behind it with it."""
    mission = dock(0, 1)
    names = tuple(mission.tasks[k].name for k in (1, 2))
    both = replace(mission, zones=(*mission.zones, Zone("gate", tasks=names)))
    assert ends(both, *IN_TURN) == [4, 7, 10]
    assert ends(both, (0, 0), (2, 2), (1, 1)) == [4, 8, 5]


def test_what_takes_no_time_needs_room_and_takes_none() -> None:
    assert ends(dock(0, 1, 2, durations=(0, 3, 0)), *IN_TURN) == [1, 5, 5]
    assert ends(dock(0, 1, 2, durations=(0, 0, 0)), *IN_TURN) == [1, 2, 2]


def test_nobody_begins_a_task_in_a_zone_in_passing() -> None:
    """A robot on its way to 9 passes both others, and does the one that is in no zone."""
    alone = make([robot("a", 0)], [task("a", x) for x in (9, 2, 5)])
    assert ends(alone, (0, 0), (1, 0), (2, 0)) == [9, 2, 5]
    zone = Zone("dock", tasks=(alone.tasks[1].name,))
    assert ends(replace(alone, zones=(zone,)), (0, 0), (1, 0), (2, 0)) == [9, 16, 5]


def test_without_a_plan_the_shared_order_says_who_is_next() -> None:
    """Both are there in step 1; which is first in the paper's order begins, of two rooms both."""
    mission = make([robot("a", 2), robot("a", 6)], [task("a", x, duration=3) for x in (5, 3)])
    zones = (Zone("dock", area=((3, 0), (5, 0))),)
    env = TeamFormation([replace(mission, zones=zones)])
    first, second = env.worlds.order[0, :2].tolist()
    play(env, 7)
    done = dict(enumerate(env.worlds.tasks["done_at"][0].tolist()))
    assert (done[first], done[second]) == (4, 7)


def drawn(rng: np.random.Generator, kind: str, is_plane: bool) -> Mission:
    """Draw a mission with zones, and with something else."""
    while True:
        mission = random_world(rng, is_plane=is_plane)
        if "loads" in kind:
            mission = with_loads(mission, rng)
        if kind == "unsure":
            mission = with_surprises(mission, rng)
        if kind == "after":
            mission = with_precedence_and_windows(mission, rng)
        if "optional" in kind:
            mission = with_optional(mission, rng)
        try:
            mission = with_shifts(mission, rng) if "shifts" in kind else mission
            mission = with_batteries(mission, rng) if "batteries" in kind else mission
            return (with_docks if "loads" in kind else with_zones)(mission, rng)
        except MissionError:  # no shift is long enough, or there is no charger in some part
            continue


@pytest.mark.parametrize("is_plane", [False, True], ids=["grid", "plane"])
@pytest.mark.parametrize("kind", KINDS)
def test_step_with_zones_is_what_the_plain_twin_does(is_plane: bool, kind: str) -> None:
    rng = np.random.default_rng(53 + is_plane)
    full = done = 0
    for number in range(24):
        mission = drawn(rng, kind, is_plane)
        truth = draw_truth(mission, number)
        coordinator = [None, RandomPlans(number)][number % 2]
        env = TeamFormation([mission], truths=[truth], coordinator=coordinator)
        twin = Twin(env)
        while env.is_running[0] and env.tally().steps < 80:
            view = env.view()
            is_planned = coordinator is not None and rng.random() < 0.8
            decision = env.planned_decision(view) if is_planned else random_decision(view, rng)
            twin.step(view, decision)
            for room in twin.world.rooms:
                under_way = len(room.inside(at_work(twin.world)))
                assert under_way <= room.room
                full += under_way == room.room
        done += env.tally().tasks_done
    assert full > 20
    assert done > 20


def at_work(world: PlainWorld) -> AtWork:
    """Return what takes room in zones."""
    return AtWork(world.served - world.carried, world.unloading & world.served)


@pytest.mark.parametrize("name", METHODS)
def test_records_of_missions_with_zones_are_legal_and_kept(name: str) -> None:
    rng = np.random.default_rng(11)
    full = 0
    for number, kind in enumerate(KINDS * 3):
        mission = drawn(rng, kind, number % 3 == 0)
        record = run_trial(mission, METHODS[name]).record
        assert judge(record).findings == ()
        may_stop = ("step limit",) * ("shifts" in kind)  # the paper's methods know of no shifts
        assert record.end.status in ("completed", "too late", "infeasible", *may_stop)
        assert record_from_tree(record_to_tree(record), "it") == record
        full += times_full(record)
    assert full > 8


def test_crews_wait_for_nobody_whose_shifts_are_over() -> None:
    """In some of these missions they would wait for robots that work no more from step 8, 19 or 17.

    Crews are dealt anew when a last shift ends; as they are dealt, some would wait for it to begin.
    """
    for seed in (5, 77):
        rng = np.random.default_rng(seed)
        for _ in range(6):
            record = run_trial(drawn(rng, "shifts", False), Crews()).record
            assert judge(record).findings == ()
            assert record.end.status != "step limit"


def times_full(record: Record) -> int:
    """Return how often a service began that filled a zone; say that none ever held more."""
    told: ToldRecord = told_of(record)
    moments = {it.begun for it in told.services}
    lies = {row.task: (row.x, row.y) for step in record.steps for row in step.left}
    filled = 0
    for room in all_rooms_of(record.true_mission) if not lies else ():
        for moment in moments:
            on = [it for it in told.services if it.begun <= moment < (it.ended or moment + 1)]
            inside = sum(it.task in room.tasks and it.doing in ("serving", "loading") for it in on)
            inside += sum(it.task in room.loads and it.doing == "unloading" for it in on)
            assert inside <= room.room
            filled += inside == room.room
    return filled


PIANO = replace(task("a", 2, duration=2), to=(9, 0), unload=3)
DOCK = Zone("dock", places=((9, 0),))


def at_a_dock(*tasks: Task, robots: tuple[int, ...] = (0, 12), zone: Zone = DOCK) -> Mission:
    """Return robots in a corridor, one for each task, and a zone."""
    return replace(make([robot("a", x) for x in robots], tasks), zones=(zone,))


@pytest.mark.parametrize(
    ("sign", "room", "ends_at"),
    [
        (10, 2, [14, 13]),  # the piano is taken up in steps 3 and 4, carried 7 cells, unloaded
        (10, 1, [16, 13]),  # it is there at 11, and unloaded once the sign is done
        (8, 1, [14, 11]),  # which is done in the step in which it comes
        (1, 1, [14, 4]),
    ],
)
def test_a_team_with_a_load_waits_until_there_is_room(
    sign: int, room: int, ends_at: list[int]
) -> None:
    """The sign is begun in step 3."""
    zone = replace(DOCK, room=room)
    mission = at_a_dock(PIANO, task("a", 9, duration=sign), zone=zone)
    assert ends(mission, (0, 0), (1, 1)) == ends_at


def test_a_load_leaves_room_as_it_is_carried() -> None:
    """The sign is beside it and begins in step 4, with which the piano is on its way."""
    both = replace(DOCK, places=(PIANO.at, (3, 0)))
    mission = at_a_dock(PIANO, task("a", 3, duration=5), robots=(0, 4), zone=both)
    assert ends(mission, (0, 0), (1, 1)) == [14, 9]


def test_who_brings_a_load_is_before_who_is_to_begin() -> None:
    """Both are there in step 10, and the plan has the sign first."""
    quick, sign = replace(PIANO, duration=1), task("a", 9, duration=5)
    for room, ends_at in ((1, [13, 18]), (2, [13, 15])):
        mission = at_a_dock(quick, sign, robots=(0, 19), zone=replace(DOCK, room=room))
        assert ends(mission, (1, 1), (0, 0)) == ends_at


def test_a_load_within_a_zone_does_not_wait_for_itself() -> None:
    hall = Zone("hall", area=((0, 0), (19, 0)))
    assert ends(at_a_dock(PIANO, robots=(0,), zone=hall), (0, 0)) == [14]
    assert ends(at_a_dock(replace(PIANO, to=(2, 0)), robots=(0,), zone=hall), (0, 0)) == [7]
    assert ends(at_a_dock(replace(PIANO, unload=0), robots=(0,), zone=hall), (0, 0)) == [11]


def test_what_a_team_with_a_load_waits_for_is_told() -> None:
    """It waits in steps 12 and 13; the path goes by way of the sign."""
    mission = at_a_dock(PIANO, task("a", 9, duration=10))
    record = run_trial(mission, Given((0, 0), (1, 1))).record
    assert judge(record).findings == ()
    told = told_of(record)
    [waits] = [run for run in told.runs[0] if run.phase == "waiting"]
    assert waits.begun == 11
    assert [told.texts[why] for why in waits.why] == ["it waits for room in dock, where t1 goes on"]
    assert [(it.begin, it.end, it.doing, it.task, it.zone) for it in told.path] == [
        (0, 3, "walking", 1, -1),
        (3, 13, "serving", 1, -1),
        (13, 16, "unloading", 0, 0),
    ]


def test_a_load_that_is_set_down_in_a_zone_takes_room_there() -> None:
    """Robot 0 is lost in step 8 with the piano at 5; robot 1, which is there at 9, lifts it again.

    The sign at 6 may begin in step 11, with which the piano is on its way again.
    """
    hall = Zone("hall", area=((4, 0), (7, 0)))
    mission = at_a_dock(PIANO, task("a", 6, duration=5), robots=(0, 9, 11), zone=hall)
    lost = replace(mission.robots[0], absences=(Absence(8),))
    mission = replace(mission, robots=(lost, *mission.robots[1:]))
    record = run_trial(mission, SharedPlan()).record
    assert judge(record).findings == ()
    assert record.end.status == "completed"
