"""Other people's files: what is read, and what is told of files that are broken."""

from __future__ import annotations

import copy
import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

import teamformer as tf
from home_care import HHCRSP
from orienteering import CHAO
from teamformer.base.errors import TeamformerError
from teamformer.files.imports import import_missions
from teamformer.mission.parts.roads import Roads

HETERO = {
    "setup": {"robots": 2, "tasks": 1, "num_skills": 2},
    "tasks": {"0": {"pos": {"x": 0.5, "y": 0.25}, "skillset": {"0": 1, "1": 1}, "duration": 1.5}},
    "robots": {
        "0": {"pose": {"x": 0.1, "y": 0.2}, "skillset": {"0": 1, "1": 0}},
        "1": {"pose": {"x": 0.9, "y": 0.8}, "skillset": {"0": 0, "1": 1}},
    },
}
SADCHER = {
    "Q": [[1, 0], [0, 1]],
    "R": [[1, 0], [1, 1]],
    "T_e": [5, 6],
    "loc": [[0, 0], [3, 4], [6, 8], [9, 9]],
    "prec": [[1, 2]],
}


PUBLISHED = {
    "Q": [[1, 0], [0, 1]],
    "R": [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 0.0]],
    "T_e": [0, 5, 6, 0],
    "task_locations": [[0, 0], [3, 4], [6, 8], [9, 12]],
    "precedence_constraints": [[1, 2]],
    "T_t": [[0, 5, 10, 15], [5, 0, 5, 10], [10, 5, 0, 5], [15, 10, 5, 0]],
}
"""The form in which SADCHER's authors publish their instances."""


def write(path: Path, tree: Any) -> Path:
    path.write_text(json.dumps(tree))
    return path


def test_hetero_mrta(tmp_path: Path) -> None:
    [mission] = import_missions("hetero-mrta", write(tmp_path / "env_7.json", HETERO))
    assert (mission.name, mission.time, mission.ends) == ("env_7", "continuous", "home")
    assert [robot.name for robot in mission.robots] == ["r0", "r1"]
    assert {robot.speed for robot in mission.robots} == {0.2}
    [task] = mission.tasks
    assert (task.name, task.at, task.duration) == ("t0", (0.5, 0.25), 1.5)
    assert task.needs == {"skill-0": 1, "skill-1": 1}


def test_sadcher(tmp_path: Path) -> None:
    one, two = import_missions("sadcher", write(tmp_path / "some.json", [SADCHER, SADCHER]))
    assert (one.name, two.name, one.ends) == ("some-0", "some-1", (9, 9))
    assert one.tasks[1].after == ("t1",)
    assert one.tasks[1].at == (6, 8)
    assert {robot.at for robot in one.robots} == {(0, 0)}


def test_sadcher_as_its_authors_publish_it(tmp_path: Path) -> None:
    [mission] = import_missions("sadcher", write(tmp_path / "p_1.json", PUBLISHED))
    short = SADCHER | {"loc": PUBLISHED["task_locations"]}
    [same] = import_missions("sadcher", write(tmp_path / "p_1.json", short))
    assert mission == same
    assert [(task.name, task.at, task.duration) for task in mission.tasks] == [
        ("t1", (3, 4), 5),
        ("t2", (6, 8), 6),
    ]
    made = tf.plan(mission, method="reactive")
    assert made is not None
    assert made.makespan == pytest.approx(26)  # r0 walks 15 in all and serves 5 and 6


def test_sadcher_goes_by_the_times_that_its_file_has(tmp_path: Path) -> None:
    rounded = PUBLISHED | {"T_t": [[0, 5, 9, 15], [5, 0, 4, 10], [10, 5, 0, 5], [15, 10, 5, 0]]}
    [mission] = import_missions("sadcher", write(tmp_path / "p_1.json", rounded))
    assert isinstance(mission.world, Roads)
    assert mission.world.places == ("start", "t1", "t2", "end")
    assert (mission.robots[0].at, mission.ends) == ((0, 0), (3, 0))
    made = tf.plan(mission, method="reactive")
    assert made is not None
    assert made.makespan == pytest.approx(25)
    tf.save(mission, tmp_path / "p_1.yaml")
    assert tf.load(tmp_path / "p_1.yaml") == mission


@pytest.mark.parametrize("precedence", [None, []])
def test_sadcher_without_precedence(precedence: Any, tmp_path: Path) -> None:
    free = PUBLISHED | {"precedence_constraints": precedence}
    [mission] = import_missions("sadcher", write(tmp_path / "p_1.json", free))
    assert [task.after for task in mission.tasks] == [(), ()]


def test_hhcrsp(tmp_path: Path) -> None:
    [mission] = import_missions("hhcrsp", write(tmp_path / "care.json", HHCRSP))
    assert (mission.name, mission.time, mission.ends) == ("care", "continuous", "home")
    assert mission.cost == {"travel": 1, "tardiness": 1, "max_tardiness": 1}
    assert [(robot.name, dict(robot.can)) for robot in mission.robots] == [
        ("c1", {"s1": 1, "s2": 1}),
        ("c2", {"s2": 1}),
    ]
    one, first, second = mission.tasks
    assert (one.name, first.name, second.name) == ("p1", "p2-s1", "p2-s2")
    assert isinstance(mission.world, Roads)
    places = [mission.world.name_of(at) for at in (one.at, first.at, mission.robots[0].at)]
    assert places == ["p1", "p2", "d"]
    assert mission.world.times == {"ground": ((0, 5, 5), (7, 0, 6), (5, 6, 0))}
    assert (one.duration, first.duration, second.duration) == (6, 4, 7)
    assert (one.between, first.between, second.between) == ((10, 26), (0, 34), (0, 37))
    assert (one.starts, first.starts, second.starts) == ({}, {}, {"p2-s1": (5, 9)})


def test_simultaneous_services_start_at_once(tmp_path: Path) -> None:
    tree: Any = copy.deepcopy(HHCRSP)
    tree["patients"][1]["synchronization"] = {"type": "simultaneous"}
    tree["patients"][1]["required_caregivers"][1]["service"] = "s1"
    tree["caregivers"][1]["abilities"] = ["s1"]
    [mission] = import_missions("hhcrsp", write(tmp_path / "care.json", tree))
    assert [task.name for task in mission.tasks] == ["p1", "p2-1", "p2-2"]
    assert mission.tasks[2].starts == {"p2-1": (0, 0)}


@pytest.mark.parametrize(
    ("place", "value", "told"),
    [
        (("distances", 1), [5, 0], "distances is not square: row 1 has 2 of 3 numbers"),
        (("distances", 1), [5, 0, -9], "distances has -9 from p1 to p2; here should be 0 or more"),
        (("patients", 0, "id"), "d", "patients has 'd' twice, as a patient or the office"),
        (("distances",), [[0, 5], [5, 0]], "has 2 rows; here should be one for each of 3 places"),
        (("patients", 0), {"id": "p1"}, "patients[0] lacks 'required_caregivers'"),
        (("patients", 0, "time_window"), [9, 2], "time_window goes from 9 to 2; the smaller one"),
        (("patients", 0, "time_window"), [9], "time_window has 1 entries; here should be two"),
        (("patients", 0, "required_caregivers", 0, "service"), "s9", "is 's9', which is not under"),
        (("patients", 1, "synchronization", "type"), "soon", "is 'soon'; here should be simult"),
        (("patients", 1, "required_caregivers"), [{"service": "s1"}] * 3, "has 3 services; one or"),
        (("caregivers", 0, "abilities"), ["s2"], "task 'p2-s1' needs 's1' but no robot has it"),
        (("caregivers",), HHCRSP["caregivers"][:1], "'p2-s1', 'p2-s2' are done by different"),
        (("central_offices",), [{}, {}], "central_offices has 2 offices; here one is known"),
    ],
)
def test_hhcrsp_files_that_are_broken(
    place: tuple[Any, ...], value: Any, told: str, tmp_path: Path
) -> None:
    tree: Any = copy.deepcopy(HHCRSP)
    part = tree
    for key in place[:-1]:
        part = part[key]
    part[place[-1]] = value
    with pytest.raises(TeamformerError) as caught:
        import_missions("hhcrsp", write(tmp_path / "care.json", tree))
    assert told in str(caught.value)
    assert caught.value.hint


def test_team_orienteering(tmp_path: Path) -> None:
    """Two paths of 10 take what lies within 3 and within 9, and cannot take 11.3 + 9.4."""
    path = tmp_path / "p0.2.a.txt"
    path.write_text(CHAO)
    [mission] = import_missions("top", path)
    assert isinstance(mission, tf.Mission)
    assert mission.until == 10
    assert [task.weight for task in mission.tasks if task.optional] == [7, 5, 20]
    trial = tf.run(mission, method="plan")
    assert trial.check().is_legal
    assert trial.completed
    assert trial.record.end.missed == ("t3",)
    assert trial.makespan == 10


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("n 5\nm 2\n", ":3: here should be 'tmax NUMBER'"),
        ("n 5\nm two\ntmax 10\n", ":2: 'two' is no number"),
        (CHAO.replace("n 5", "n 6"), "n says 6 points, and there are 5"),
        (CHAO.replace("m 2", "m 0"), "m is 0"),
        (CHAO.replace("9 9 20", "9 9"), ":7: here should be a point"),
        (CHAO.replace("9 9 20", "9 9 -20"), ":7: the score is -20"),
    ],
)
def test_team_orienteering_files_that_are_broken(text: str, told: str, tmp_path: Path) -> None:
    path = tmp_path / "p0.2.a.txt"
    path.write_text(text)
    with pytest.raises(TeamformerError, match=re.escape(told)):
        import_missions("top", path)


def unchanged(graph: dict[str, Any]) -> None:
    pass


def dcmrta_folder(folder: Path, change: Callable[[dict[str, Any]], None] = unchanged) -> Path:
    """Write an instance of three tasks around a depot; nodes 3 and 4 are the depot."""
    places = np.array([[0.1, 0.1], [0.9, 0.2], [0.4, 0.8], [0.5, 0.5], [0.5, 0.5]])
    pairs = [(i, j) for i in range(4) for j in (0, 1, 2, 4) if i != j and (i, j) != (3, 4)]
    graph: dict[str, Any] = {}
    for number, (i, j) in enumerate(pairs):
        distance = float(np.linalg.norm(places[i] - places[j]))
        graph[f"edge{number}"] = [i, j, 0, distance, 0, distance / 0.2]
    graph |= {f"node{n}": 1.0 + n for n in range(3)}
    change(graph)
    tasks = {f"task{n}": {"and0": {"or0": {"capId": 0, "capReq": n + 1.0}}} for n in range(3)}
    for name, tree in (
        ("graph", {"vehicle0": graph}),
        ("task_param", tasks),
        ("vehicle_param", {"vehicle0": {"capVector": [1.0]}}),
        ("planner_param", {"vehNumPerType": [5]}),
    ):
        (folder / f"{name}.yaml").write_text(yaml.safe_dump(tree))
    return folder


def test_dcmrta_places_are_worked_out_from_the_ways(tmp_path: Path) -> None:
    [mission] = import_missions("dcmrta", dcmrta_folder(tmp_path))
    assert len(mission.robots) == 5
    assert [task.needs["robot"] for task in mission.tasks] == [1, 2, 3]
    assert [task.duration for task in mission.tasks] == [1, 2, 3]
    spots = np.array([*(task.at for task in mission.tasks), mission.robots[0].at])
    true = np.array([[0.1, 0.1], [0.9, 0.2], [0.4, 0.8], [0.5, 0.5]])
    found, wanted = (np.linalg.norm(p[:, None] - p[None], axis=2) for p in (spots, true))
    assert np.abs(found - wanted).max() < 1e-9
    assert mission.robots[0].speed == pytest.approx(0.2)


def lengthened(graph: dict[str, Any]) -> None:
    graph["edge0"][3] *= 9
    graph["edge0"][5] *= 9


def bent(graph: dict[str, Any]) -> None:
    for name, edge in graph.items():
        if name.startswith("edge") and set(edge[:2]) == {0, 1}:
            edge[3], edge[5] = edge[3] * 1.1, edge[5] * 1.1


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda graph: graph.pop("edge0"), "graph.yaml: vehicle0 is not square: no edge goes"),
        (lengthened, "vehicle0 breaks the triangle inequality: from node 0 to node 1"),
        (bent, "vehicle0 does not hold straight ways in a plane: from node"),
        (lambda graph: graph["edge1"].__setitem__(5, 99.0), "vehicle0 has speeds from"),
        (lambda graph: graph["edge1"].__setitem__(0, 77), "goes from 77 to 2, but there are 3"),
        (lambda graph: graph["edge1"].__setitem__(3, "far"), "edge1[3] is 'far'; here should be"),
        (lambda graph: graph.pop("node2"), "vehicle0 lacks 'node2'"),
    ],
)
def test_dcmrta_graphs_that_are_broken(
    change: Callable[[dict[str, Any]], None], told: str, tmp_path: Path
) -> None:
    with pytest.raises(TeamformerError) as caught:
        import_missions("dcmrta", dcmrta_folder(tmp_path, change))
    assert told in str(caught.value)
    assert caught.value.hint


@pytest.mark.parametrize(
    ("place", "value", "told"),
    [
        (("setup", "tasks"), 20, "setup.tasks is 20, but the file holds 1"),
        (("tasks", "0", "duration"), -1, "tasks.0.duration is -1; here should be a number, 0 or"),
        (("tasks", "0", "duration"), None, "tasks.0.duration is None; here should be a number"),
        (("tasks", "0", "skillset", "1"), 2, "needs 2 x skill-1 but all robots together"),
        (("tasks", "0", "skillset"), {"5": 1}, "task 't0' needs 'skill-5' but no robot has it"),
        (("tasks", "0", "pos"), [1, 2], "tasks.0.pos lacks 'x'"),
        (("robots", "1", "pose", "x"), float("nan"), "robots.1.pose.x is nan; here should be"),
        (("robots",), {}, "robots is {}; here should be a list or a mapping with entries"),
        (("robots", "0", "skillset", "0"), 0.5, "skillset.0 is 0.5; here should be a whole"),
    ],
)
def test_hetero_mrta_files_that_are_broken(
    place: tuple[str, ...], value: Any, told: str, tmp_path: Path
) -> None:
    tree: Any = copy.deepcopy(HETERO)
    part = tree
    for key in place[:-1]:
        part = part[key]
    part[place[-1]] = value
    path = write(tmp_path / "env.json", tree)
    with pytest.raises(TeamformerError) as caught:
        import_missions("hetero-mrta", path)
    assert str(caught.value).startswith(f"{path}: ")
    assert told in str(caught.value)
    assert caught.value.hint


@pytest.mark.parametrize(
    ("key", "value", "told"),
    [
        ("prec", [[1, 2], [2, 1]], "'t1', which is after 't2', which is after 't1'; break this"),
        ("prec", [[1, 3]], "prec[0] names task 3; there are 2"),
        ("T_e", [5], "T_e has 1 entries; with 2 tasks it should be 2"),
        ("loc", [[0, 0], [1, 1]], "loc has 2 entries; with 2 tasks it should be 4"),
        ("R", [[1, 0], [1]], "R has rows of different lengths"),
        ("R", [[1, 0], [0, 0]], "task 't2' needs nothing; name at least one capability"),
    ],
)
def test_sadcher_files_that_are_broken(key: str, value: Any, told: str, tmp_path: Path) -> None:
    with pytest.raises(TeamformerError) as caught:
        import_missions("sadcher", write(tmp_path / "one.json", SADCHER | {key: value}))
    assert told in str(caught.value)


@pytest.mark.parametrize(
    ("key", "value", "told"),
    [
        ("R", [[0, 0], [1, 0], [1, 1]], "T_e has 4 entries; with 1 tasks it should be 3"),
        ("R", [[0, 0], [0, 0]], "R has no tasks between the start and the end"),
        ("R", [[0, 1], [1, 0], [1, 1], [0, 0]], "R[0][1] is 1; here is the start, so 0"),
        ("R", [[0, 0], [1, 0], [1, 1], [1, 0]], "R[3][0] is 1; here is the end, so 0"),
        ("T_e", [0, 5, 6, 7], "T_e[3] is 7; here is the end, so 0"),
        ("task_locations", [[0, 0]] * 3, "task_locations has 3 entries; with 2 tasks it should be"),
        ("precedence_constraints", [[1, 3]], "precedence_constraints[0] names task 3; there are 2"),
        ("T_t", [[0, 1], [1, 0]], "T_t has 2 rows; here should be one for each of 4 places"),
        ("T_t", [[0, -1, 1, 1]] * 4, "T_t has -1 from start to t1; here should be 0 or more"),
    ],
)
def test_published_sadcher_files_that_are_broken(
    key: str, value: Any, told: str, tmp_path: Path
) -> None:
    with pytest.raises(TeamformerError) as caught:
        import_missions("sadcher", write(tmp_path / "one.json", PUBLISHED | {key: value}))
    assert told in str(caught.value)
    assert caught.value.hint


def test_files_that_are_cut_off_and_formats_that_are_unknown(tmp_path: Path) -> None:
    path = tmp_path / "cut.json"
    path.write_text(json.dumps(HETERO, indent=1)[:200])
    with pytest.raises(TeamformerError, match=r"cut.json:\d+: this is not whole JSON; was it cut"):
        import_missions("hetero-mrta", path)
    with pytest.raises(TeamformerError, match="format 'mrta' is unknown"):
        import_missions("mrta", path)
    with pytest.raises(TeamformerError, match="this is no folder"):
        import_missions("dcmrta", path)
    (dcmrta_folder(tmp_path) / "graph.yaml").write_text("vehicle0: {edge0: [0, 1")
    with pytest.raises(TeamformerError, match=r"graph.yaml:\d+: this is not whole YAML"):
        import_missions("dcmrta", tmp_path)
