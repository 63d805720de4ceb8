"""Records of missions in continuous time as files: read as written, and every damage is told."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from hand_logs import BEAM, EVENTS, RECORD
from teamformer.base.errors import RecordError
from teamformer.record.files.reading import read_record, record_from_tree
from teamformer.record.files.writing import record_to_tree, save_record
from teamformer.record.happenings import events
from teamformer.record.record import Ending, Record
from teamformer.record.task_times import (
    cancelled_steps,
    cost_of_record,
    done_steps,
    judged_value,
    known_steps,
    lateness,
)
from teamformer.record.teams import completions
from teamformer.world.continuous.events import KINDS, Event


def written(record: Record) -> Any:
    """Return the tree of a record that is surely its own."""
    return record_to_tree(record)


def test_what_is_written_is_read(tmp_path: Path) -> None:
    path = tmp_path / "record.json"
    save_record(RECORD, path)
    assert read_record(path) == RECORD
    first = path.read_bytes()
    save_record(read_record(path), path)
    assert path.read_bytes() == first


def test_an_event_is_a_line_that_leaves_out_what_it_does_not_say(tmp_path: Path) -> None:
    path = tmp_path / "record.json"
    save_record(RECORD, path)
    lines = path.read_text(encoding="utf-8").splitlines()
    begin = lines.index('"events": [')
    assert lines[begin + 1 : begin + 3] == [
        '[0,"plan",{"plan":[["start"],[[0,[0,1],10],[1,[0],14.75]]]}],',
        '[0,"walk",{"robots":[0],"task":0,"until":2,"way":[[0,[0,0]],[1,[1,0]],[2,[2,0]]],'
        '"cause":0}],',
    ]
    assert lines[begin + 16 : begin + 18] == [
        '[14.75,"over",{"cause":14,"status":"completed"}]',
        "],",
    ]
    assert not {"steps", "start", "orders", "plans", "decisions"} & set(record_to_tree(RECORD))


ANY = {
    "robots": (1, 0),
    "task": BEAM,
    "place": (3, 0),
    "until": 7.25,
    "way": EVENTS[1].way,
    "plan": EVENTS[0].plan,
    "needs": {"lift": 1, "weld": 0.5},
    "status": "infeasible",
    "why": "too late",
}


@pytest.mark.parametrize("kind", KINDS)
def test_an_event_of_each_kind_is_read_as_written(kind: str) -> None:
    fields = {key: ANY[key] for key in KINDS[kind].fields}
    least = {key: value for key, value in fields.items() if key not in KINDS[kind].may_lack}
    happened = (Event(1.5, kind, **least), Event(1.5, kind, **fields, cause=0))
    record = replace(RECORD, events=happened if kind != "over" else happened[1:])
    assert record_from_tree(written(record), "it") == record


def test_an_ending_is_read_as_written() -> None:
    late = Ending(
        "infeasible",
        None,
        tasks_done=1,
        blocked_tasks=("crate",),
        cost=2.5,
        late={"beam": 0.125},
        broken_links=(("beam", "crate"),),
    )
    record = replace(RECORD, end=late)
    assert record_from_tree(written(record), "it") == record
    assert lateness(record) == {"beam": 0.125}
    assert cost_of_record(record) == judged_value(record) == 2.5


def edited(change: Callable[[Any], None]) -> str:
    """Return what reading says of the tree of the record with a change."""
    tree = written(RECORD)
    change(tree)
    with pytest.raises(RecordError) as caught:
        record_from_tree(tree, "it")
    assert caught.value.hint == "run the mission again to have it written anew"
    return str(caught.value).removeprefix("it: the record is damaged: ")


def put(event: int, key: str, value: Any) -> Callable[[Any], None]:
    """Return the change that gives an event another value of a key."""
    return lambda tree: tree["events"][event][2].update({key: value})


def at(event: int, when: Any) -> Callable[[Any], None]:
    return lambda tree: tree["events"][event].__setitem__(0, when)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (
            put(1, "robots", [2]),
            "event 1: walk: robots: 2 stands where a number from 0 to 1 belongs",
        ),
        (
            put(1, "robots", []),
            "event 1: walk: there are no robots; leave the key out or name them",
        ),
        (put(1, "task", "beam"), "event 1: walk: task: 'beam' stands where a whole number belongs"),
        (put(1, "until", -1), "event 1: walk: until: -1 stands where 0 or more belongs"),
        (put(1, "until", None), "event 1: walk: until: None stands where a number belongs"),
        (put(1, "way", []), "event 1: walk: way: it has no places"),
        (put(1, "way", [[0, [8, 0]]]), "event 1: walk: way: [8, 0] is outside the world"),
        (
            put(1, "way", [[0, [0.5, 0]]]),
            "event 1: walk: way: 0.5 stands where a whole number belongs",
        ),
        (
            put(1, "way", [[2, [1, 0]], [1, [2, 0]]]),
            "event 1: walk: way: a place is passed at 1, after one at 2",
        ),
        (
            put(1, "cause", 16),
            "event 1: walk: cause: 16 stands where a number from 0 to 15 belongs",
        ),
        (
            put(3, "way", []),
            "arrive: the key 'way' means nothing; known are robots, task, place, cause",
        ),
        (
            put(15, "status", "lost"),
            "event 15: over: status: the status is 'lost', not one of "
            "('completed', 'step limit', 'infeasible', 'too late', 'interrupted')",
        ),
        (
            lambda tree: tree["events"][4][2].pop("place"),
            "event 4: arrive: the key 'place' is missing",
        ),
        (
            lambda tree: tree["events"][4].pop(),
            "event 4: [8, 'arrive'] stands where a list of 3 belongs",
        ),
        (at(3, "2"), "event 3: '2' stands where a number belongs"),
        (at(3, float("nan")), "event 3: nan stands where a number belongs"),
        (at(3, 9), "event 4: it happens at 8, and the one before at 9"),
        (lambda tree: tree.update(events=7), "events: 7 stands where a list belongs"),
        (lambda tree: tree.update(steps=[]), "the key 'steps' means nothing"),
        (lambda tree: tree.pop("events"), "the key 'events' is missing"),
        (lambda tree: tree["end"].pop("late"), "end: the key 'late' is missing"),
        (lambda tree: tree["end"].update(late=[]), "end: late: [] stands where a mapping belongs"),
        (lambda tree: tree["end"].update(makespan="14"), "end: '14' stands where a number belongs"),
        (
            lambda tree: tree["end"].update(broken_links=[["a"]]),
            "end: ['a'] stands where a list of 2 belongs",
        ),
    ],
)
def test_damage_is_told(change: Callable[[Any], None], said: str) -> None:
    assert said in edited(change)


def test_an_event_of_no_kind_is_refused_with_the_kinds() -> None:
    said = edited(lambda tree: tree["events"][1].__setitem__(1, "fly"))
    assert "event 1: 'fly' is no kind of event; known are plan, walk, arrive" in said


def test_nothing_happens_after_the_end() -> None:
    def end_early(tree: Any) -> None:
        tree["events"][-1], tree["events"][-2] = tree["events"][-2], tree["events"][-1]

    assert edited(end_early) == "events: something happens after the mission is over"


def test_when_tasks_were_known_and_over() -> None:
    assert known_steps(RECORD) == [0, 0]
    assert done_steps(RECORD) == {0: 10, 1: 14.75}
    assert cancelled_steps(RECORD) == {}
    assert list(completions(RECORD)) == [(10, 0, (0, 1)), (14.75, 1, (0,))]
    assert judged_value(RECORD) == 14.75


def test_the_log_of_a_record() -> None:
    told = [(it.at, it.text(RECORD.mission)) for it in events(RECORD)]
    assert told == [
        (10, "beam done by ann, bob"),
        (11.25, "crate taken up by ann"),
        (14.75, "crate done by ann"),
        (14.75, "completed"),
    ]
