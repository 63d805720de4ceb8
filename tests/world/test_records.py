"""The record's file: what goes in comes out, and no damage to it ends in a traceback."""

from __future__ import annotations

import json
import random
import reprlib
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from teamformer.base.errors import RecordError, TeamformerError
from teamformer.mission.model import Absence, Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.mission.parts.plane import Plane
from teamformer.record.files.reading import read_record, record_from_tree
from teamformer.record.files.writing import record_to_tree, save_record
from teamformer.record.record import Ending, Record, Step, TeamAt
from teamformer.record.telling.whole import path_of_record

HALL = Mission(
    name="hall",
    world=Grid(4, 2, ("....", ".@.."), y_axis="down"),
    capabilities=("lift", "größe"),
    robots=(
        Robot("ann", (0, 0), {"lift": 1}),
        Robot("bob", (0, 0), {"größe": 2}, speed=0.5),
        Robot("cat", (3, 1), {"lift": 1}, absences=(Absence(2),)),
    ),
    tasks=(Task("x", (2, 0), {"lift": 1}), Task("y", (0, 1), {"größe": 1}, appears=1)),
    teams=((0, 1),),
    sensing_radius=float("inf"),
)
"""The file does not care whether its steps are legal, so these are not."""

RECORD = Record(
    mission=HALL,
    method="by hand",
    seed=7,
    orders=((0, (0,)), (1, (1, 0))),
    start=((0, (0, 1), 0, 0), (2, (2,), 3, 1)),
    steps=(
        Step(splits=(((0,), (1,)),), teams=(TeamAt(1, 0, 0, None),)),
        Step(lost=(2,), teams=(TeamAt(0, 1, 0, 0),)),
        Step(),
        Step(joins=((1, 0),), teams=(TeamAt(0, 2, 0, None),), done=((0, 0),)),
    ),
    end=Ending("interrupted", None, 4, 1, 1, 1, 0, ("y",)),
    lower_bound=3,
)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "record.json"


def test_what_is_written_is_read(path: Path) -> None:
    save_record(RECORD, path)
    assert read_record(path) == RECORD


def test_of_a_fleet_nobody_may_know_who_did_a_task(path: Path) -> None:
    last = replace(RECORD.steps[3], done=((0, None),))
    record = replace(RECORD, method="fleet", steps=(*RECORD.steps[:3], last))
    save_record(record, path)
    assert read_record(path) == record
    assert path_of_record(replace(record, end=replace(record.end, makespan=4))) == ()


def test_the_same_record_gives_the_same_bytes(path: Path) -> None:
    save_record(RECORD, path)
    first = path.read_bytes()
    save_record(read_record(path), path)
    assert path.read_bytes() == first


def test_a_step_is_a_line_and_says_only_what_changed(path: Path) -> None:
    save_record(RECORD, path)
    lines = path.read_text(encoding="utf-8").splitlines()
    begin = lines.index('"steps": [')
    assert lines[begin + 1 : begin + 6] == [
        '{"splits":[[[0],[1]]],"teams":[[1,0,0]]},',
        '{"lost":[2],"teams":[[0,1,0,0]]},',
        "{},",
        '{"joins":[[1,0]],"teams":[[0,2,0,null]],"done":[[0,0]]}',
        "],",
    ]


def test_the_file_is_json_for_other_programs(path: Path) -> None:
    save_record(RECORD, path)

    def refuse(word: str) -> None:
        raise AssertionError(f"{word} is no JSON")

    tree = json.loads(path.read_bytes(), parse_constant=refuse)
    assert tree == record_to_tree(RECORD)
    assert tree["teamformer_record"] == 3
    assert tree["method"] == "by hand"
    assert not {"order", "new_tasks", "allocation", "foresight"} & set(tree["mission"])


def test_a_record_without_steps_is_read(path: Path) -> None:
    still = replace(RECORD, steps=(), lower_bound=None)
    save_record(still, path)
    assert read_record(path) == still


def test_a_method_named_by_bytes_that_are_no_text_is_kept(path: Path) -> None:
    strange = replace(RECORD, method="mine-\udcff.onnx")  # what Python makes of byte 255
    save_record(strange, path)
    assert read_record(path) == strange


def test_a_failed_write_leaves_the_old_file_and_no_litter(path: Path) -> None:
    save_record(RECORD, path)
    before = path.read_bytes()
    unwritable = replace(RECORD, seed=object())  # type: ignore[arg-type]
    with pytest.raises(TypeError):
        save_record(unwritable, path)
    assert path.read_bytes() == before
    (path.parent / "folder").mkdir()
    with pytest.raises(OSError, match="folder"):
        save_record(RECORD, path.parent / "folder")
    assert sorted(entry.name for entry in path.parent.iterdir()) == ["folder", "record.json"]


def refusal(path: Path) -> RecordError:
    with pytest.raises(RecordError) as caught:
        read_record(path)
    assert caught.value.hint
    return caught.value


def test_a_missing_file_is_told(path: Path) -> None:
    assert str(refusal(path)) == f"{path}: there is no such file"


def test_a_folder_is_told_with_the_file_in_it(path: Path) -> None:
    error = refusal(path.parent)
    assert str(error) == f"{path.parent}: this is a folder"
    assert str(path) in error.hint


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", ":1: it breaks off"),
        (b"\xff\xfe", ": this is not text: byte 1 is no UTF-8"),
        (b"steps: 3", ":1: this is not JSON: Expecting value"),
        (b"# a yard\nteamformer: 1\n", ": this is a mission, not a record"),
        (b'{\n"a": 1,}', ":2: this is not JSON: Expecting property name enclosed in double quotes"),
        (b"[" * 100_000, ": this is no record: lists lie in lists in lists"),
        (b"9" * 5000, ": this is no record: a number has thousands of digits"),
        (b"[]", ": this is not a record: it has no 'teamformer_record'"),
        (b'{"teamformer": 1}', ": this is not a record: it has no 'teamformer_record'"),
        (b'{"teamformer_record": 4}', ": format 4 is newer than 3"),
        (
            b'{"teamformer_record": 1}',
            ": format 1 is of an earlier teamformer, which wrote other keys",
        ),
        (
            b'{"teamformer_replay": 2}',
            ": its format is of an earlier teamformer, which called a record 'teamformer_replay'",
        ),
        (b'{"teamformer_record": 0}', ": the format version is 0, not a number from 1 on"),
        (b'{"teamformer_record": true}', ": the format version is True, not a number from 1 on"),
        (
            b'{"teamformer_record": 3, "seed": 1, "end": {"steps": 1, "steps": 2}}',
            ": the record is damaged: the key 'steps' stands twice in one mapping",
        ),
        (b'{"teamformer_record": 3}', ": the record is damaged: the key 'mission' is missing"),
    ],
)
def test_what_is_no_record_is_told(path: Path, data: bytes, message: str) -> None:
    path.write_bytes(data)
    assert str(refusal(path)) == f"{path}{message}"


def test_every_cut_is_told_as_one(path: Path) -> None:
    save_record(RECORD, path)
    whole = path.read_text(encoding="utf-8")
    for length in range(len(whole.rstrip())):
        path.write_text(whole[:length], encoding="utf-8")
        line = whole[:length].count("\n") + 1
        half_letter = "this is not JSON: Invalid \\uXXXX escape"
        told = str(refusal(path))
        assert told in (f"{path}:{line}: it breaks off", f"{path}:{line}: {half_letter}")


def damage(*where: str | int, to: Any) -> Callable[[dict[str, Any]], None]:
    """Return what puts a value at a path into a tree."""

    def change(tree: Any) -> None:
        for key in where[:-1]:
            tree = tree[key]
        tree[where[-1]] = to

    return change


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (damage("steps", to=3), "3 stands where a list belongs"),
        (damage("steps", 2, to=[]), "step 3: [] stands where a mapping belongs"),
        (
            damage("steps", 2, "jions", to=[]),
            "step 3: the key 'jions' means nothing; "
            "known are joins, splits, lost, back, teams, done, named, took, heard, shown, found, "
            "moved, taken, left, pursued, served, unloads, missed, charge",
        ),
        (
            damage("steps", 2, "heard", to=[[0, 1, "song"]]),
            "step 3: what was heard is 'song', not one of ('beat', 'facts', 'plan')",
        ),
        (damage("steps", 3, "joins", to=[[1]]), "step 4: [1] stands where a list of 2 belongs"),
        (
            damage("steps", 3, "joins", 0, 1, to=3),
            "step 4: 3 stands where a number from 0 to 2 belongs",
        ),
        (
            damage("steps", 3, "joins", 0, 1, to=-1),
            "step 4: -1 stands where a number from 0 to 2 belongs",
        ),
        (
            damage("steps", 0, "splits", 0, 1, to=[3]),
            "step 1: 3 stands where a number from 0 to 2 belongs",
        ),
        (
            damage("steps", 1, "lost", 0, to=True),
            "step 2: True stands where a whole number belongs",
        ),
        (
            damage("steps", 1, "teams", 0, 1, to=1.0),
            "step 2: 1.0 stands where a whole number belongs",
        ),
        (
            damage("steps", 1, "teams", 0, 3, to=2),
            "step 2: 2 stands where a number from 0 to 1 belongs",
        ),
        (
            damage("steps", 3, "done", 0, 0, to=2),
            "step 4: 2 stands where a number from 0 to 1 belongs",
        ),
        (
            damage("steps", 3, "done", 0, 1, to=None),
            "a task is done by nobody, which only the record of a fleet may say",
        ),
        (damage("orders", 1, 1, to={}), "orders: {} stands where a list belongs"),
        (damage("orders", 1, 0, to=-1), "orders: -1 stands where 0 or more belongs"),
        (damage("start", 0, to="abcd"), "start: 'abcd' stands where a list of 4 belongs"),
        (damage("method", to=1), "1 stands where a text belongs"),
        (
            damage("foresight", to=["absent"]),
            "the foresight is ['absent'], not one of ('needed', 'absent', 'scouting')",
        ),
        (damage("seed", to=None), "None stands where a whole number belongs"),
        (damage("end", to=None), "end: None stands where a mapping belongs"),
        (damage("end", "joins", to=None), "end: None stands where a whole number belongs"),
        (damage("end", "splits", to=-1), "end: -1 stands where 0 or more belongs"),
        (
            damage("end", "status", to="won"),
            "end: the status is 'won', not one of "
            "('completed', 'step limit', 'infeasible', 'too late', 'interrupted')",
        ),
        (damage("end", "blocked_tasks", to=[1]), "end: 1 stands where a text belongs"),
        (damage("lower_bound", to="3"), "'3' stands where a whole number belongs"),
        (damage("lower_bound", to=2**53 + 1), f"{2**53 + 1} is more than a record can count"),
        (
            damage("steps", 1, "teams", 0, 1, to=10**400),
            f"step 2: {reprlib.repr(10**400)} is more than a record can count",
        ),
    ],
)
def test_damage_is_told_with_its_step(
    change: Callable[[dict[str, Any]], None], message: str
) -> None:
    tree = record_to_tree(RECORD)
    change(tree)
    with pytest.raises(RecordError) as caught:
        record_from_tree(tree, "r.json")
    assert str(caught.value) == f"r.json: the record is damaged: {message}"


@pytest.mark.parametrize("value", [10**400, -(10**9) - 1, float("nan")])
def test_a_point_beyond_all_planes_is_damage(value: float) -> None:
    tree = record_to_tree(replace(RECORD, mission=replace(HALL, world=Plane(4, 4))))
    tree["steps"][1]["teams"][0][1] = value
    with pytest.raises(RecordError, match=r"step 2: .* stands where a number belongs"):
        record_from_tree(tree, "r.json")


def test_a_seed_may_have_any_number_of_digits() -> None:
    record = replace(RECORD, seed=10**400)
    assert record_from_tree(record_to_tree(record), "r.json") == record


@pytest.mark.parametrize("key", record_to_tree(RECORD)["end"])
def test_the_ending_must_be_whole(key: str) -> None:
    tree = record_to_tree(RECORD)
    del tree["end"][key]
    with pytest.raises(RecordError, match=f"end: the key '{key}' is missing"):
        record_from_tree(tree, "r.json")


def test_a_mistake_in_the_mission_is_told_with_the_file(path: Path) -> None:
    tree = record_to_tree(RECORD)
    tree["mission"]["robots"][1]["speed"] = -1
    path.write_text(json.dumps(tree), encoding="utf-8")
    with pytest.raises(TeamformerError, match="'bob' has speed -1") as caught:
        read_record(path)
    assert str(path) in str(caught.value)


JUNK = (None, True, -1, 2, 10**30, 0.5, float("inf"), "", "x", [], [[]], [1, 2], {}, {"a": 1})


def places(tree: Any, where: tuple[str | int, ...] = ()) -> Iterator[tuple[str | int, ...]]:
    """Return the path to everything in a tree."""
    pairs = tree.items() if isinstance(tree, dict) else enumerate(tree)
    for key, value in pairs:
        yield (*where, key)
        if isinstance(value, dict | list):
            yield from places(value, (*where, key))


def test_junk_anywhere_is_refused_or_harmless() -> None:
    """A tree with junk in it is either refused with a message or a record like any other."""
    refused = 0
    for where in places(record_to_tree(RECORD)):
        for junk in JUNK:
            tree = record_to_tree(RECORD)
            damage(*where, to=junk)(tree)
            told = ""
            try:
                record = record_from_tree(tree, "r.json")
            except TeamformerError as error:
                told = str(error)
                refused += 1
            assert (
                told.startswith("r.json: ")
                or record_from_tree(record_to_tree(record), "r.json") == record
            )
    assert refused > 1000


def test_no_damage_to_the_bytes_ends_in_a_traceback(path: Path) -> None:
    rng = random.Random(2)
    save_record(RECORD, path)
    whole = path.read_bytes()
    for _ in range(300):
        data = bytearray(whole)
        for _ in range(rng.randint(1, 3)):
            at = rng.randrange(len(data))
            data[at : at + rng.choice((0, 1, 9))] = rng.choice(
                (b"", b"[", b"}", b"-", b"7", b"\xc3")
            )
        path.write_bytes(data)
        told = str(path)
        try:
            read_record(path)
        except TeamformerError as error:
            told = str(error)
        assert told.startswith(str(path))
