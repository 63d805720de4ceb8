"""Records written for other tools, read back by those tools' own libraries."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from coordinations import COORDINATIONS, method_of
from small_worlds import make, robot, task
from teamformer.base.errors import TeamformerError
from teamformer.cli.verbs.records.export import export
from teamformer.methods.by_name import load_method
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.mission.model import Absence, Breakdown, Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.record.export.csv_tables import write_tables
from teamformer.record.export.moments import moments
from teamformer.record.export.reasons import explain, story_lines
from teamformer.record.files.reading import read_record
from teamformer.record.files.writing import save_record
from teamformer.record.phases import FORMING, IDLE, LOST, SERVING, WAITING, WALKING
from teamformer.record.record import Ending, Record, SharedPlanMade, Step, TeamAt
from teamformer.record.referee import judge
from teamformer.record.telling.plans_in_force import PlansInForce
from teamformer.trials.trial import run_trial


def two_lifters() -> Record:
    """Two walk a cell to a beam and wait, join, lift for two steps; then one is lost.

    a..B..b   steps: walk, walk, join, serve, serve, lost
    """
    mission = Mission(
        name="beam",
        world=Grid(5, 2, rows=(".....", "@@@@@")),
        capabilities=("lift",),
        robots=(
            Robot("a", (0, 0), {"lift": 1}),
            Robot("=b", (3, 0), {"lift": 1}, absences=(Absence(6),)),
        ),
        tasks=(
            Task("beam", (2, 0), {"lift": 2}, duration=2),
            Task("box", (4, 0), {"lift": 1}, appears=6),
        ),
    )
    steps = (
        Step(teams=(TeamAt(0, 1, 0, 0), TeamAt(1, 2, 0, 0))),
        Step(teams=(TeamAt(0, 2, 0, 0),)),
        Step(joins=((1, 0),), served=((0, (0, 1)),)),
        Step(),
        Step(done=((0, 0),), teams=(TeamAt(0, 2, 0, None),)),
        Step(lost=(1,)),
    )
    end = Ending("interrupted", None, 6, 1, 1, 0, 0)
    start = ((0, (0,), 0, 0), (1, (1,), 3, 0))
    return Record(mission, "by hand", 0, ((0, (0,)),), start, steps, end=end)


def test_every_step_of_every_robot_has_its_phase() -> None:
    phases = list(zip(*(moment.phase for moment in moments(two_lifters())), strict=True))
    assert phases == [
        (IDLE, WALKING, WALKING, FORMING, SERVING, SERVING, IDLE),
        (IDLE, WALKING, WAITING, FORMING, SERVING, SERVING, LOST),
    ]


def test_places_and_teams_are_those_of_the_record() -> None:
    seen = list(moments(two_lifters()))
    assert [moment.place[0] for moment in seen] == [(0, 0), (1, 0), *[(2, 0)] * 5]
    assert [moment.team for moment in seen[2:]] == [(0, 1), (0, 0), (0, 0), (0, 0), (0, -1)]
    assert [moment.task[0] for moment in seen] == [-1, 0, 0, 0, 0, -1, -1]


SERVES = "its team brings all that the task needs, and stays until that is done"


def test_a_robot_says_what_it_did_and_why() -> None:
    record = replace(two_lifters(), orders=((0, (0,)), (5, ())))
    assert list(story_lines(record, 0)) == [
        ("1-2", "walks to beam", "first in the order that everybody shares"),
        ("3-3", "forms with =b", ""),
        ("4-5", "serves beam, with =b", SERVES),
        ("6-6", "idle", "no task is open"),
    ]
    assert list(story_lines(record, 1))[1:2] == [
        ("2-2", "waits at beam", "lacks lift, which a brings"),
    ]
    assert list(story_lines(record, 1))[-1] == ("6-6", "lost", "")


def test_a_shared_plan_says_who_does_what_and_who_took_whose_part() -> None:
    before = two_lifters()
    plans = ((0, SharedPlanMade(("start",), ((0,),))),)
    steps = (replace(before.steps[0], took=((0, 1),)), *before.steps[1:])
    record = replace(before, plans=plans, steps=steps)
    told = [why for _, _, why in story_lines(record, 0)]
    assert told[0] == "the plan has a do it"
    held, doing = PlansInForce(), []
    for made in range(3):
        for pair in record.steps[made - 1].took if made else ():
            held.exchange(*pair)
        held.go_on(record, made)
        doing.append(held.coalition(0))
    assert doing == [(0,), (1,), (1,)]


class CountedSteps(tuple[Step, ...]):
    """Steps of a record that count how many of them were handed out."""

    handed_out = 0

    def __iter__(self) -> Iterator[Step]:
        for step in super().__iter__():
            self.handed_out += 1
            yield step

    def __getitem__(self, which: Any) -> Any:
        found = super().__getitem__(which)
        self.handed_out += len(found) if isinstance(which, slice) else 1
        return found


def much_happens(steps: int) -> Record:
    """Three robots break down again and again beside a task that waits for who is away for good."""
    lame = replace(robot("a", 1), breaks=Breakdown(0.1, (2, 5)))
    away = replace(robot("b", 5), absences=(Absence(3, 900_000),))
    tasks = [task("a", 3), task("b", 8)]
    mission = make([lame] * 3 + [away], tasks, step_limit=steps)
    return run_trial(mission, SharedPlan()).record


@pytest.mark.parametrize("tells", ["story", "mcap"])
def test_a_record_is_gone_through_once_however_much_happens(tells: str, tmp_path: Path) -> None:
    """Each of the few readers of a record looks at each step a few times."""
    write: Any = None
    if tells == "mcap":
        write = pytest.importorskip("teamformer.record.export.mcap_file").write_mcap
    for steps in (100, 800):
        record = much_happens(steps)
        counted = CountedSteps(record.steps)
        record = replace(record, steps=counted)
        if tells == "mcap":
            write(record, tmp_path / "record.mcap")
        else:
            assert len(explain(record, 0)) > steps / 10
        assert steps <= counted.handed_out <= 10 * steps


def test_plans_made_anew_say_after_what() -> None:
    """The box appears after step 1 beside =b, who is the first to be sent there."""
    before = two_lifters()
    tasks = (before.mission.tasks[0], replace(before.mission.tasks[1], appears=1))
    steps = (Step(), Step(teams=(TeamAt(1, 4, 0, 1),), done=((1, 1),)))
    end = Ending("interrupted", None, 2, 1, 0, 0, 0)
    record = replace(
        before,
        mission=replace(before.mission, tasks=tasks),
        orders=((0, (0,)), (1, (1, 0))),
        steps=steps,
        end=end,
    )
    assert list(story_lines(record, 1)) == [
        ("1-1", "idle", "others are to do beam"),
        (
            "2-2",
            "walks to box",
            "first in the order that everybody shares; planned anew after step 1: box appears",
        ),
    ]


def rows_of(path: Path) -> list[list[str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.reader(file))


def test_tables_hold_what_was_recorded(tmp_path: Path) -> None:
    write_tables(two_lifters(), tmp_path)
    assert rows_of(tmp_path / "robots.csv")[1:] == [
        ["a", "lift", "1.0", "ground", "0", "0", "", "", *"201200010"],
        ["'=b", "lift", "1.0", "ground", "3", "0", "6", "", *"111200001"],
    ]
    assert rows_of(tmp_path / "tasks.csv")[1:] == [
        ["beam", "2 x lift", "2", "0", "2", *[""] * 6, "0", "", "3", "5", "", "a, =b"],
        ["box", "lift", "4", "0", "0", *[""] * 6, "6", *[""] * 5],
    ]
    assert [(row[0], row[2], row[5]) for row in rows_of(tmp_path / "events.csv")[1:]] == [
        ("3", "joins", "a, =b are one team"),
        ("5", "done", "beam done by a, =b"),
        ("6", "lost", "'=b lost"),
        ("6", "appears", "box appears"),
        ("6", "interrupted", "interrupted"),
    ]
    bars = [row for row in rows_of(tmp_path / "gantt.csv")[1:] if row[0] == "a"]
    assert [(row[1], row[3], row[4]) for row in bars] == [
        ("walking", "0", "2"), ("forming", "2", "3"), ("serving", "3", "5"), ("idle", "5", "6"),
    ]  # fmt: skip


def test_tables_have_notes_where_there_are_some(tmp_path: Path) -> None:
    record = two_lifters()
    mission = record.mission
    robots = (replace(mission.robots[0], note="leaks, =oil"), *mission.robots[1:])
    tasks = (mission.tasks[0], replace(mission.tasks[1], note="=dock 3"))
    write_tables(replace(record, mission=replace(mission, robots=robots, tasks=tasks)), tmp_path)
    head, *robot_rows = rows_of(tmp_path / "robots.csv")
    assert head[-1] == "note"
    assert [row[-1] for row in robot_rows] == ["leaks, =oil", ""]
    head, *task_rows = rows_of(tmp_path / "tasks.csv")
    column = head.index("note")
    assert [row[column] for row in task_rows] == ["", "'=dock 3"]


def test_the_table_of_tasks_has_windows_precedence_loads_and_lateness(tmp_path: Path) -> None:
    """By hand: sets out in 2, there in 3, loaded in 6, carried to 10, unloaded in 12; 1 back."""
    load = replace(task("a", 2, duration=3), to=(6, 0), unload=2, between=(1.0, 8.5))
    next_one = replace(task("a", 5), after=("t0",), between=(0.0, 20.0))
    record = run_trial(make([robot("a", 0)], [load, next_one]), load_method("join-all")).record
    write_tables(record, tmp_path)
    with (tmp_path / "tasks.csv").open(encoding="utf-8", newline="") as file:
        first, second = csv.DictReader(file)
    told = {
        **{"to_x": "6", "to_y": "0", "unload": "2", "after": "", "not_before": "1.0", "due": "8.5"},
        **{"begun_in_step": "3", "done_in_step": "12", "late_by": "3.5", "done_by": "r0"},
    }
    assert {key: first[key] for key in told} == told
    told = {
        **{"to_x": "", "to_y": "", "unload": "", "after": "t0", "not_before": "0.0", "due": "20.0"},
        **{"begun_in_step": "13", "done_in_step": "13", "late_by": "", "done_by": "r0"},
    }
    assert {key: second[key] for key in told} == told


def carried() -> Record:
    """A robot that walks 2 to a load, takes 3 to load it, carries it 4 and unloads it for 2."""
    load = replace(task("a", 2, duration=3), to=(6, 0), unload=2)
    mission = make([robot("a", 0)], [load])
    return run_trial(mission, load_method("join-all")).record


def test_loading_carrying_and_unloading_are_told_everywhere(tmp_path: Path) -> None:
    record = carried()
    write_tables(record, tmp_path)
    phases = [("walking", 2), ("loading", 3), ("carrying", 4), ("unloading", 2)]
    bars = rows_of(tmp_path / "gantt.csv")[1:]
    assert [(bar[1], int(bar[4]) - int(bar[3])) for bar in bars] == phases
    assert [chapter.what for chapter in explain(record, 0)] == [
        "walks to t0",
        "loads t0",
        "carries t0",
        "unloads t0",
    ]
    pytest.importorskip("foxglove")
    from teamformer.record.export.mcap_file import write_mcap

    write_mcap(record, tmp_path / "load.mcap")
    found = mcap_messages(tmp_path / "load.mcap")
    scenes = [data for topic, _, data, _ in found if topic == "/mission"]
    assert [
        (name, sum(b"phase\x12" + bytes([len(name)]) + name.encode() in scene for scene in scenes))
        for name, _ in phases
    ] == phases


def mcap_messages(path: Path) -> list[tuple[str, int, Any, str]]:
    """Return (topic, log time, data, schema) of every message, by the mcap library alone."""
    reader = pytest.importorskip("mcap.reader")
    with path.open("rb") as file:
        return [
            (channel.topic, message.log_time, message.data, schema.name)
            for schema, channel, message in reader.make_reader(file).iter_messages()
        ]


def test_the_mcap_file_holds_frames_scene_map_and_log(tmp_path: Path) -> None:
    pytest.importorskip("foxglove")
    from teamformer.record.export.mcap_file import write_mcap

    path = tmp_path / "beam.mcap"
    write_mcap(two_lifters(), path)
    found = mcap_messages(path)
    assert len(found) == 1 + 7 + 7 + 5
    assert {(topic, schema) for topic, _, _, schema in found} == {
        ("/tf", "foxglove.FrameTransforms"),
        ("/mission", "foxglove.SceneUpdate"),
        ("/map", "foxglove.Grid"),
        ("/log", "foxglove.Log"),
    }
    times = [time for topic, time, _, _ in found if topic == "/tf"]
    assert times == [step * 1_000_000_000 for step in range(7)]
    last = next(data for topic, time, data, _ in found if topic == "/tf" and time == times[-1])
    assert b"robot/a" in last
    assert b"robot/=b" not in last  # lost
    assert any(b"=b lost" in data for topic, _, data, _ in found if topic == "/log")
    scene = next(data for topic, _, data, _ in found if topic == "/mission")
    assert b"2 x lift" in scene  # what the task needs


def test_the_record_becomes_a_mission_again(tmp_path: Path) -> None:
    from teamformer.files.mission_files import read_mission

    record = tmp_path / "record.json"
    save_record(two_lifters(), record)
    assert export(record, [tmp_path / "again.yaml"]) == 0
    assert read_mission(tmp_path / "again.yaml") == two_lifters().mission
    with pytest.raises(TeamformerError, match=r"again\.yaml: there is such a file"):
        export(record, [tmp_path / "again.yaml", tmp_path / "tables"])
    assert not (tmp_path / "tables").exists()


def test_export_says_what_it_wrote(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    record = tmp_path / "record.json"
    save_record(replace(two_lifters(), seed=3), record)
    assert export(record, [tmp_path / "tables", tmp_path / "again.yaml"]) == 0
    files = [Path(line.removeprefix("file: ")) for line in capsys.readouterr().err.splitlines()]
    assert [file.name for file in files] == [
        "robots.csv", "tasks.csv", "events.csv", "gantt.csv", "again.yaml",
    ]  # fmt: skip
    assert all(file.is_file() for file in files)


@pytest.mark.parametrize("record", [None, "no record"])
def test_a_record_that_cannot_be_read_leaves_nothing_behind(
    record: str | None, tmp_path: Path
) -> None:
    path = tmp_path / "record.json"
    if record is not None:
        path.write_text(record)
    before = set(tmp_path.iterdir())
    with pytest.raises(TeamformerError):
        export(path, [tmp_path / "tables", tmp_path / "films" / "mission.gif"])
    assert set(tmp_path.iterdir()) == before


@pytest.mark.parametrize(
    ("name", "told"),
    [("x.csv", "the ending says no format"), ("record.json", "this is the record itself")],
)
def test_what_cannot_be_exported_is_refused(name: str, told: str, tmp_path: Path) -> None:
    record = tmp_path / "record.json"
    save_record(two_lifters(), record)
    before = record.read_bytes()
    with pytest.raises(TeamformerError, match=re.escape(told)):
        export(record, [tmp_path / "good.yaml", tmp_path / name])
    assert record.read_bytes() == before
    assert not (tmp_path / "good.yaml").exists()


def test_a_gif_shows_every_step(tmp_path: Path) -> None:
    """Cells are 48 pixels; two robots of one colour walk to the beam, three frames a step."""
    image = pytest.importorskip("PIL.Image", reason="the extra `gif` is not installed")
    record, path = tmp_path / "record.json", tmp_path / "mission.gif"
    save_record(two_lifters(), record)
    assert export(record, [path]) == 0
    shown, begin = {}, 0
    with image.open(path) as film:
        assert film.size == (
            360,
            2 * 48 + 2 * 12 + 30 + 28,
        )  # wide enough for what the caption says
        for frame in range(film.n_frames):
            film.seek(frame)
            shown[begin] = film.convert("RGB")
            begin += film.info["duration"]
    assert begin == 6 * 150 + 2500
    middle = [(12 + 48 * x + 24, 12 + 48 + 24) for x in range(5)]  # of the lower cells
    disc = [(x - 12, y) for x, y in middle]  # of the first of two robots in one place
    orange = shown[0].getpixel(disc[0])
    assert orange[0] > orange[2] + 150
    assert shown[150].getpixel(disc[1]) == orange
    assert shown[50].getpixel((disc[0][0] + 16, disc[0][1])) == orange  # a third of the way
    assert min(shown[150].getpixel(disc[0])) > 240
    assert shown[0].getpixel((30, 30)) == shown[900].getpixel((220, 30))  # the wall
    beam = (middle[4][0] - 20, middle[4][1])
    assert min(shown[0].getpixel(beam)) > 240  # not there yet
    assert min(shown[900].getpixel(beam)) < 200


def test_a_long_mission_has_no_more_frames_than_can_be_watched(tmp_path: Path) -> None:
    gif = pytest.importorskip("teamformer.record.export.gif_file", reason="no extra `gif`")
    quiet = replace(
        two_lifters(), steps=(Step(),) * 1200, end=Ending("interrupted", None, 1200, 0, 0, 0, 0)
    )
    gif.write_gif(quiet, tmp_path / "long.gif")
    with pytest.importorskip("PIL.Image").open(tmp_path / "long.gif") as long:
        assert long.n_frames == 401  # every third moment and the last; none between two


def news_each_step(coordination: str = "paper") -> Record:
    """A slow robot walks two cells to its task in eight steps, after each of which one appears."""
    calls = [task("b", 19, appears=steps) for steps in range(1, 8)]
    robots = [robot("a", 0, speed=0.25), robot("b", 19)]
    mission = make(robots, [task("a", 2), *calls])
    return run_trial(mission, method_of(coordination)).record


@pytest.mark.parametrize("coordination", COORDINATIONS)
def test_who_walks_slowly_is_not_idle_while_news_comes_in_every_step(
    coordination: str, tmp_path: Path
) -> None:
    record = news_each_step(coordination)
    assert judge(record).findings == ()
    assert [dict(step.pursued).get(0) for step in record.steps[:7]] == [0] * 7
    seen = list(moments(record))
    assert [moment.phase[0] for moment in seen[1:9]] == ["walking"] * 8
    assert [moment.pursued[0] for moment in seen[1:9]] == [0] * 8
    assert explain(record, 0)[0].what == "walks to t0"
    save_record(record, tmp_path / "record.json")
    assert read_record(tmp_path / "record.json") == record


@pytest.mark.parametrize(
    ("pursued", "told"),
    [
        (((0, 7),), "in the record the team of robot r0 pursued task t7"),
        (((0, 0), (0, 0)), "the rows of pursued are not in order, each of them once"),
    ],
)
def test_what_cannot_have_been_pursued_is_found(
    pursued: tuple[tuple[int, int], ...], told: str
) -> None:
    record = news_each_step()
    steps = (replace(record.steps[0], pursued=pursued), *record.steps[1:])
    findings = judge(replace(record, steps=steps)).findings
    assert [told in str(finding) for finding in findings] == [True]
