"""What is learned from records of a site, by hand arithmetic and on sites whose rules are known."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import teamformer as tf
from teamformer.files.mission_files import mission_from_tree, read_mission, write_mission
from teamformer.trials.advice.experience import Lesson
from typed import teamformer

HERE, THERE = (2, 2), (30, 2)


def mission(places: Sequence[tuple[int, int]], lasts: tuple[int, int] = (0, 9)) -> tf.Mission:
    """Return a mission with a task at each place that may need `b` and lasts nobody knows how long.

    Every robot brings all, so that whoever is there can do it.
    """
    tasks = tuple(
        tf.Task(f"t{number}", at, {"a": 1}, lasts=lasts, may_need={"b": 0.5})
        for number, at in enumerate(places)
    )
    robots = tuple(tf.Robot(f"r{n}", at, {"a": 1, "b": 1}) for n, at in enumerate((HERE, THERE)))
    return tf.Mission("site", tf.Grid(32, 5), ("a", "b"), robots, tasks)


def as_it_was(of: tf.Mission, durations: Sequence[int], with_b: Sequence[bool]) -> tf.Mission:
    """Return what a mission really was."""
    told = zip(of.tasks, durations, with_b, strict=True)
    tasks = tuple(
        task.once_known(task.at, {"a": 1, "b": 1} if has_b else {"a": 1}, duration)
        for task, duration, has_b in told
    )
    return replace(of, tasks=tasks)


def lessons_of(experience: tf.Experience, what: str) -> list[Lesson]:
    return [lesson for lesson in experience.lessons if lesson.what == what]


def test_what_the_file_says_counts_as_one_task_more() -> None:
    """Six tasks in one place take 3 steps, four need b: (0.5 + 4) / 7. Of ten durations each is
    said to be a tenth as likely: 0.3 of 7 lie below 3, so 4% do, and 0.3 of 7 above 6."""
    past = mission([HERE] * 6)
    truth = as_it_was(past, [3] * 6, [True] * 4 + [False] * 2)
    experience = tf.learn(mission([HERE]), [tf.run(past, truth=truth).record])
    [task] = experience.mission.tasks
    assert task.may_need == {"b": 0.64}
    assert task.lasts == (3, 6)
    assert experience.lessons == (
        Lesson("t0", "duration", "0 to 9", "3 to 6", 6.0),
        Lesson("t0", "may need b", "0.5", "0.64", 6.0),
    )


def test_what_happens_always_is_learned_as_nearly_sure() -> None:
    past = mission([HERE] * 30)
    records = [tf.run(past, truth=as_it_was(past, [3] * 30, [False] * 30)).record for _ in range(4)]
    [task] = tf.learn(mission([HERE]), records).mission.tasks
    assert (task.lasts, task.may_need) == ((3, 3), {"b": 0.01})


def test_ranges_may_be_as_long_as_files_allow_and_what_is_sure_stays_sure() -> None:
    past = mission([HERE] * 30, (0, 10**9))
    records = [tf.run(past, truth=as_it_was(past, [3] * 30, [True] * 30)).record]
    tasks = tuple(
        replace(task, may_need={"b": chance})
        for task, chance in zip(past.tasks[:2], (0, 1), strict=True)
    )
    zero, one = tf.learn(replace(past, tasks=tasks), records).mission.tasks
    assert (zero.may_need, one.may_need) == ({"b": 0}, {"b": 1})
    assert zero.lasts == (3, 3)


def test_near_tasks_tell_more_where_places_differ() -> None:
    """Here tasks take 2 steps and need b, there 8 and do not; in the middle nobody knows."""
    places = [(x + dx, 2) for x in (1, 28) for dx in range(4)] * 3
    past = mission(places)
    truth = as_it_was(past, [2 if x < 16 else 8 for x, _ in places], [x < 16 for x, _ in places])
    records = [tf.run(past, truth=truth).record] * 5
    experience = tf.learn(mission([HERE, THERE, (16, 2)]), records)
    here, there, middle = experience.mission.tasks
    assert (here.duration, there.duration) == (2, 8)
    assert here.may_need["b"] > 0.9 > 0.1 > there.may_need["b"]
    assert middle.may_need["b"] == pytest.approx(0.5, abs=0.1)


@pytest.mark.thorough
def test_tasks_of_the_same_kind_tell_more_where_kinds_differ() -> None:
    """Tasks that need b for sure take 8 steps, others 2, and both lie everywhere."""
    rng, records = np.random.default_rng(3), []
    sure = [number % 2 == 0 for number in range(24)]
    for _ in range(6):
        past = mission([(int(x), int(y)) for x, y in rng.integers((0, 0), (32, 5), (24, 2))])
        tasks = tuple(
            replace(task, needs={"a": 1, "b": 1} if is_sure else {"a": 1}, may_need={})
            for task, is_sure in zip(past.tasks, sure, strict=True)
        )
        past = replace(past, tasks=tasks)
        truth = as_it_was(past, [8 if is_sure else 2 for is_sure in sure], sure)
        records.append(tf.run(past, truth=truth).record)
    with_b, without = tf.learn(replace(past, tasks=tasks[:2]), records).mission.tasks
    assert with_b.lasts == (8, 8)
    assert without.lasts == (2, 8)  # what it needs the others need too


def test_what_has_not_shown_itself_is_not_learned() -> None:
    past = replace(
        mission([(9, 2), (20, 2)], (0, 99)), step_limit=3
    )  # nobody is there before it is over
    record = tf.run(past, truth=as_it_was(past, [9, 9], [True, True])).record
    assert record.end.status == "step limit"
    experience = tf.learn(past, [record])
    assert experience.mission == past
    assert {lesson.weight for lesson in experience.lessons} == {0.0}


@pytest.mark.thorough
def test_a_value_is_learned_from_many_sites_as_it_is() -> None:
    """The rule of a random site is found again: chances by halves of the map, within 0.1."""
    rng = np.random.default_rng(5)
    places = [(int(x), int(y)) for x, y in rng.integers((0, 0), (32, 5), (40, 2))]
    past = mission(places, (1, 3))
    records = []
    for _ in range(10):
        with_b = [bool(rng.random() < (0.8 if x < 16 else 0.2)) for x, _ in places]
        truth = as_it_was(past, [2] * 40, with_b)
        records.append(tf.run(past, method="crews", truth=truth).record)
    learned = tf.learn(past, records).mission.tasks
    for task in learned:
        if abs(task.at[0] - 16) > 4:
            assert task.may_need["b"] == pytest.approx(0.8 if task.at[0] < 16 else 0.2, abs=0.15)


def test_a_record_of_another_world_is_refused() -> None:
    past = replace(mission([HERE]), world=tf.Grid(33, 5))
    with pytest.raises(tf.TeamformerError, match="is of another world than the mission"):
        tf.learn(mission([HERE]), [tf.run(past).record])


def test_where_all_is_known_there_is_nothing_to_learn() -> None:
    known = as_it_was(mission([HERE]), [1], [False])
    with pytest.raises(tf.TeamformerError, match="no task of 'site' has an uncertain duration"):
        tf.learn(known, [tf.run(known).record])


def test_a_truth_of_another_mission_is_refused() -> None:
    of = mission([HERE])
    truth = as_it_was(of, [1], [False])
    other_task = replace(truth, tasks=(replace(truth.tasks[0], name="another"),))
    with pytest.raises(tf.TeamformerError, match="the truth has other tasks"):
        tf.run(of, truth=other_task)
    other_robot = replace(truth, robots=(tf.Robot("x", HERE, {"a": 1, "b": 1}),))
    with pytest.raises(tf.TeamformerError, match="the truth has other robots"):
        tf.run(of, truth=other_robot)


def test_a_truth_that_the_mission_does_not_allow_is_refused() -> None:
    of = mission([HERE])
    with pytest.raises(tf.TeamformerError, match="task t0 cannot really have been like that"):
        tf.run(of, truth=as_it_was(of, [10], [False]))


def test_the_verb_writes_the_mission_and_says_what_changed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    past, file, learned = mission([HERE] * 6), tmp_path / "next.yaml", tmp_path / "learned.yaml"
    truth = as_it_was(past, [3] * 6, [True] * 4 + [False] * 2)
    monday, empty = tmp_path / "monday", tmp_path / "empty"
    tf.run(past, truth=truth).save(monday)
    write_mission(mission([HERE]), file)
    assert teamformer("learn", str(file), str(monday), str(learned)) == 0
    assert "learned 2 of 2 uncertain values from 1 record\n" in capsys.readouterr().out
    assert read_mission(learned).tasks[0].lasts == (3, 6)
    assert teamformer("learn", str(file), str(monday), str(learned)) == 2
    assert f"{learned}: there is such a file" in capsys.readouterr().err
    empty.mkdir()
    assert teamformer("learn", str(file), str(empty), str(tmp_path / "other.yaml")) == 2
    assert f"{empty}: there is no record.json in this folder" in capsys.readouterr().err


def on_the_clock(world: dict[str, object], near: object, far: object) -> tf.Mission:
    """A robot and two tasks in continuous time, each of 1 to 9 units; one may need a second."""
    tasks = [
        {"name": name, "at": at, "needs": ["a"], "duration": [1, 9], "may_need": {"b": 0.5}}
        for name, at in (("near", near), ("far", far))
    ]
    return mission_from_tree(
        {
            "teamformer": 1,
            "time": "continuous",
            "world": world,
            "capabilities": ["a", "b"],
            "robots": [{"at": near, "can": ["a", "b"]}],
            "tasks": tasks,
        }
    )


ROADS = {"roads": "place,yard,hall,dock\nyard,0,90,1\nhall,90,0,91\ndock,1,91,0\n"}


@pytest.mark.parametrize(
    "mission",
    [on_the_clock({"grid": [100, 1]}, [0, 0], [99, 0]), on_the_clock(ROADS, "yard", "hall")],
)
def test_missions_in_continuous_time_are_learned_from(mission: tf.Mission) -> None:
    """Near takes 2.5 and needs b, far takes 7.5 and does not, each of 30 times."""
    real = [
        replace(mission.tasks[0], lasts=None, may_need={}, duration=2.5, needs={"a": 1, "b": 1}),
        replace(mission.tasks[1], lasts=None, may_need={}, duration=7.5),
    ]
    truth = replace(mission, tasks=tuple(real))
    records = [tf.run(mission, truth=truth).record] * 30
    near, far = tf.learn(mission, records).mission.tasks
    assert near.lasts == (2.52, 2.52)  # the first 200th of 1 to 9 that is no less
    assert far.lasts == (7.52, 7.52)
    assert (near.may_need, far.may_need) == ({"b": 0.98}, {"b": 0.02})
