"""What is told of records in continuous time: by hand, and of plans that are carried out."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from hand_logs import ANN, BEAM, BOB, CRATE, EVENTS, RECORD, way
from teamformer.files.drawn.named_settings import world_of
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Grid, Place
from teamformer.mission.parts.layout import layout_of
from teamformer.mission.parts.roads import Roads
from teamformer.planning.continuous.continuous_mission import pose_mission
from teamformer.planning.continuous.rules import plan_continuous
from teamformer.planning.problem.routes import MissionPlan
from teamformer.record.critical_path.stretches import CLOSED, LINKED, NEWS, UNKNOWN, Stretch
from teamformer.record.critical_path.words import why_so_late
from teamformer.record.events.tracks import tracks_of
from teamformer.record.export.reasons import story_lines
from teamformer.record.record import Ending, Record
from teamformer.record.telling.whole import path_of_record, told_of
from teamformer.record.told.told_record import Run, ToldRecord, ToldService
from teamformer.trials.continuous_trial import carry_out
from teamformer.trials.routes import routes_of
from teamformer.world.continuous.events import Event, Passed, PlanMade, PlannedTask
from teamformer.world.rules.constants import NOBODY


def deeds(told: ToldRecord, robot: int) -> tuple[Run, ...]:
    """Return what a robot did, without the reasons."""
    return tuple(run._replace(why=()) for run in told.runs[robot])


def itself(place: Place) -> Place:
    return place


def test_services_and_runs_by_hand() -> None:
    told = told_of(RECORD)
    assert told.length == 14.75
    assert told.services == (
        ToldService(BEAM, "serving", 8.5, 10, (ANN, BOB), (ANN, BOB)),
        ToldService(CRATE, "loading", 11, 11.25, (ANN,), (ANN,)),
        ToldService(CRATE, "carrying", 11.25, 14.25, (ANN,), (ANN,)),
        ToldService(CRATE, "unloading", 14.25, 14.75, (ANN,), (ANN,)),
    )
    assert deeds(told, BOB) == (
        Run(0, "walking", BEAM),
        Run(8, "forming", BEAM),
        Run(8.5, "serving", BEAM),
        Run(10, "idle", NOBODY),
    )
    assert [(run.phase, end) for end, run in told.runs_of(ANN)] == [
        ("walking", 2),
        ("waiting", 8),
        ("forming", 8.5),
        ("serving", 10),
        ("walking", 11),
        ("loading", 11.25),
        ("carrying", 14.25),
        ("unloading", 14.75),
    ]


def test_why_so_late_by_hand() -> None:
    assert why_so_late(RECORD.mission, path_of_record(RECORD)) == [
        "why so late: 14.75 are 9 walking, 0.5 forming, 1.5 serving, 0.25 loading, 3 carrying, "
        "0.5 unloading",
        "  0-10: beam: bob walks 8, forms a team 0.5, then ann serves 1.5",
        "  10-14.75: crate: ann walks 1, loads 0.25, carries 3, unloads 0.5",
    ]


def test_a_story_by_hand() -> None:
    lines = list(story_lines(RECORD, ANN))
    assert lines[:4] == [
        ("0-2", "walks to beam", "the plan has ann, bob do it together"),
        ("2-8", "waits at beam", "lacks weld, which bob brings"),
        ("8-8.5", "forms with bob", ""),
        (
            "8.5-10",
            "serves beam, with bob",
            "its team brings all that the task needs, and stays until that is done",
        ),
    ]
    assert list(story_lines(RECORD, BOB))[-1] == (
        "10-14.75",
        "idle",
        "the plan has nothing left for it",
    )


def lost_on_the_way() -> Record:
    """Bob is lost at 3, between cells 5 and 4, and back at 5; from 4 he goes on, half as fast."""
    anew = PlanMade(("robot back",), (PlannedTask(BEAM, (ANN, BOB), 11), *EVENTS[0].plan.tasks[1:]))  # type: ignore[union-attr]
    events = (
        *EVENTS[:4],
        Event(3, "lost", (BOB,), place=(4, 0)),
        Event(5, "back", (BOB,), place=(4, 0)),
        Event(5, "plan", cause=5, plan=anew),
        Event(5, "walk", (BOB,), BEAM, until=10, way=way(6, 2, 4, 3, 2), cause=6),
        Event(10, "arrive", (BOB,), BEAM, (2, 0), cause=7),
        Event(10, "cancel", task=CRATE),
        Event(10, "serve", (ANN, BOB), BEAM, (2, 0), until=11.5, cause=8),
        Event(11.5, "done", (ANN, BOB), BEAM, (2, 0), cause=10),
        Event(11.5, "over", cause=11, status="completed"),
    )
    return replace(RECORD, events=events, end=Ending("completed", 11.5, tasks_done=1))


def test_a_robot_that_is_lost_and_back() -> None:
    record = lost_on_the_way()
    told = told_of(record)
    assert deeds(told, BOB) == (
        Run(0, "walking", BEAM),
        Run(3, "lost", NOBODY),
        Run(5, "walking", BEAM),
        Run(10, "serving", BEAM),
        Run(11.5, "idle", NOBODY),
    )
    assert told.path == (
        Stretch(0, 5, NEWS),
        Stretch(5, 10, "walking", BOB, BEAM),
        Stretch(10, 11.5, "serving", BOB, BEAM),
    )
    assert list(story_lines(record, BOB))[2] == (
        "5-10",
        "walks to beam",
        "the plan has ann, bob do it together; planned anew at 5: bob back",
    )
    [_, bob] = tracks_of(record, itself)
    assert [bob.place_at(when)[0] for when in (0, 1, 2, 3, 4.9, 7, 8, 10, 12)] == [
        *(6, 5.5, 5, 4.5, 4.5),
        *(3.5, 3, 2, 2),
    ]


def test_a_service_that_breaks_off() -> None:
    events = (
        *EVENTS[:8],
        Event(9, "lost", (BOB,), place=(2, 0)),
        Event(9, "broken", (ANN,), BEAM, cause=8),
        Event(9, "over", status="infeasible", cause=9),
    )
    record = replace(RECORD, events=events, end=Ending("infeasible", None))
    told = told_of(record)
    assert told.services == (ToldService(BEAM, "serving", 8.5, 9, (ANN, BOB), (ANN, BOB)),)
    assert deeds(told, ANN)[-1] == Run(9, "idle", NOBODY)
    assert told.path == ()


def test_paths_that_begin_with_a_window_a_link_or_a_task_that_appears() -> None:
    served = Event(4, "serve", (ANN,), BEAM, (2, 0), until=6)
    ends = (Event(6, "done", (ANN,), BEAM, (2, 0), cause=-2), Event(6, "over", cause=-1))

    def path_of(*events: Event) -> tuple[Stretch, ...]:
        count = len(events)
        rest = (ends[0]._replace(cause=count - 1), ends[1]._replace(cause=count))
        end = Ending("completed", 6, tasks_done=1)
        return path_of_record(replace(RECORD, events=(*events, *rest), end=end))

    serving = Stretch(4, 6, "serving", ANN, BEAM)
    opens = Event(4, "opens", task=BEAM)
    assert path_of(opens, served._replace(cause=0)) == (Stretch(0, 4, CLOSED, task=BEAM), serving)
    appears = Event(4, "appear", task=BEAM)
    assert path_of(appears, served._replace(cause=0)) == (
        Stretch(0, 4, UNKNOWN, task=BEAM),
        serving,
    )
    later = (
        Event(0, "walk", (BOB,), CRATE, until=5, way=way(0, 1, 6, 5)),
        opens._replace(cause=3),
        served._replace(cause=1),
        Event(5, "arrive", (BOB,), CRATE, (5, 0), cause=0),
    )
    assert path_of(*later[:3], later[3]._replace(at=4)) != ()
    linked = (*later, Event(6, "done", (ANN,), BEAM, (2, 0), cause=2), Event(6, "over", cause=4))
    end = Ending("completed", 6, tasks_done=1)
    assert path_of_record(replace(RECORD, events=linked, end=end)) == (
        Stretch(0, 5, "walking", BOB, CRATE),
        Stretch(5, 4, LINKED, task=CRATE),
        serving,
    )


def clinic() -> Mission:
    """A clinic on roads that are quicker there than back; a tray is carried, a ward opens late."""
    inf = float("inf")
    rows = ((0.0, 2.0, inf, 5.0), (3.0, 0.0, 1.5, inf), (inf, 2.0, 0.0, 2.5), (5.0, inf, 2.0, 0.0))
    names = ("depot", "hall", "ward", "lab")
    roads = Roads(names, {"ground": rows})
    spot = {name: roads.at(name) for name in names}
    return Mission(
        name="clinic",
        world=roads,
        capabilities=("carry", "scan"),
        robots=(
            Robot("one", spot["depot"], {"carry": 1}),
            Robot("two", spot["hall"], {"carry": 1, "scan": 1}, speed=0.5),
            Robot("three", spot["lab"], {"scan": 1}),
        ),
        tasks=(
            Task("bed", spot["ward"], {"carry": 2}, duration=1.5),
            Task("tray", spot["lab"], {"scan": 1}, duration=0.5),
            Task("look", spot["ward"], {"scan": 1}, duration=2, between=(20, 60)),
            Task("clean", spot["hall"], {"carry": 1}, after=("bed",), duration=3),
        ),
        time="continuous",
        ends="home",
        forming=0.25,
    )


def carried_out(mission: Mission) -> tuple[Record, MissionPlan]:
    plan = plan_continuous(pose_mission(mission), "plan", 0, None)
    assert plan is not None
    return carry_out(mission, plan, "plan"), plan


def missions() -> list[Mission]:
    drawn = [world_of("4N4T-C4", seed) for seed in range(3)]
    return [clinic(), *(replace(one, time="continuous", teams=()) for one in drawn)]


@pytest.mark.parametrize("mission", missions(), ids=lambda it: it.name)
def test_a_plan_is_carried_out_as_it_was_made_and_phases_have_no_holes(
    mission: Mission,
) -> None:
    record, plan = carried_out(mission)
    told = told_of(record)
    assert routes_of(record) == plan.routes
    assert told.path[-1].end == pytest.approx(record.end.makespan, rel=1e-9)
    assert sum(it.end - it.begin for it in told.path) == pytest.approx(record.end.makespan)
    assert all(one.end == other.begin for one, other in pairwise(told.path))
    for robot, row in enumerate(told.runs):
        assert row[0].begun == 0
        assert all(one.begun < other.begun for one, other in pairwise(row))
        ends = [end for end, _ in told.runs_of(robot)]
        assert ends[-1] == told.length
    places = [task.at for task in mission.tasks]
    tracks = tracks_of(record, itself)
    for service in told.services:
        for robot in service.begun_by:
            if service.doing in ("serving", "loading"):
                assert tracks[robot].place_at(service.begun) == places[service.task]


def test_roads_are_laid_out_as_long_as_they_take() -> None:
    """Three places in a row, the middle one nearer to the first; a corridor is no detour."""
    rows = ((0.0, 2.0, 6.0), (2.0, 0.0, 4.0), (6.0, 4.0, 0.0))
    layout = layout_of(Roads(("a", "b", "c"), {"ground": rows}))
    one, two, three = (np.array(place) for place in layout.places)
    ratio = np.linalg.norm(three - two) / np.linalg.norm(two - one)
    assert ratio == pytest.approx(2, rel=0.01)
    assert layout.roads == ((0, 1), (1, 2))
    assert (layout.width, layout.height) > (6, 5)
    assert told_of(carried_out(clinic())[0]).layout is not None


def test_places_without_a_way_between_lie_apart() -> None:
    inf = float("inf")
    rows = ((0.0, 1.0, inf), (1.0, 0.0, inf), (inf, inf, 0.0))
    layout = layout_of(Roads(("a", "b", "c"), {"ground": rows}))
    assert layout.roads == ((0, 1),)
    assert len(set(layout.places)) == 3


def test_a_track_turns_round_between_places() -> None:
    record = replace(
        RECORD,
        mission=replace(RECORD.mission, world=Grid(8, 1)),
        events=(
            EVENTS[1],
            Event(0.5, "walk", (ANN,), CRATE, until=2, way=(Passed(1, (1, 0)), Passed(2, (0, 0)))),
        ),
    )
    ann, _ = tracks_of(record, itself)
    assert [ann.place_at(when)[0] for when in (0.25, 0.75, 1, 1.5, 2, 3)] == [
        0.25,
        0.75,
        1,
        0.5,
        0,
        0,
    ]
