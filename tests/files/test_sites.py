"""Sites of Open-RMF and of LIF: lanes become times, and what a file says wrong is told by place."""

from __future__ import annotations

import copy
import json
import math
from pathlib import Path
from typing import Any

import pytest
import yaml

import teamformer as tf
from teamformer.base.errors import MissionError, TeamformerError
from teamformer.cli.verbs.missions.import_ import import_
from teamformer.files.imports import import_missions
from teamformer.files.imports.site import Site
from teamformer.files.mission_files import read_mission
from teamformer.mission.parts.roads import GROUND, Roads

SITES = Path(__file__).parent / "sites"

GRAPH: dict[str, Any] = {
    "building_name": "store",
    "levels": {
        "L1": {
            "vertices": [
                [0.0, 0.0, {"name": "dock", "is_charger": True, "spawn_robot_name": "ann"}],
                [3.0, 4.0, {"name": "shelf", "pickup_dispenser": "belt"}],
                [3.0, 0.0, {"name": ""}],
                [9.0, 0.0, {"name": "lift", "lift": "east"}],
            ],
            "lanes": [
                [0, 1, {"speed_limit": 0.5}],
                [1, 2, {"is_bidirectional": True, "speed_limit": 2.0}],
                [2, 0, {}],
                [2, 3, {}],
                [3, 2, {}],
            ],
        },
        "L2": {
            "vertices": [
                [9.0, 0.0, {"name": "lift", "lift": "east"}],
                [9.0, 2.0, {"name": "lab", "dropoff_ingestor": "rack", "is_parking_spot": True}],
            ],
            "lanes": [[0, 1, {}], [1, 0, {}]],
        },
    },
}
"""Five lanes in a triangle with a tail to a lift, and a room above."""


def rmf(tmp_path: Path, tree: Any) -> tf.Mission | Site:
    path = tmp_path / "0.yaml"
    path.write_text(yaml.safe_dump(tree))
    [found] = import_missions("rmf", path)
    return found


def lif(tmp_path: Path, tree: Any) -> tf.Mission | Site:
    path = tmp_path / "site.lif.json"
    path.write_text(json.dumps(tree))
    [found] = import_missions("lif", path)
    return found


def published(number: int) -> Any:
    return json.loads((SITES / f"lif-{number:02}.json").read_text())


def roads(site: tf.Mission | Site) -> Roads:
    assert isinstance(site.world, Roads)
    return site.world


def time(site: tf.Mission | Site, begin: str, end: str, mover: str = GROUND) -> float:
    """Return how long a robot takes from one place to another."""
    world = roads(site)
    return world.ways[mover][world.places.index(begin)][world.places.index(end)]


def test_lanes_take_their_lengths_by_the_speed_that_they_allow(tmp_path: Path) -> None:
    mission = rmf(tmp_path, GRAPH)
    assert isinstance(mission, tf.Mission)
    assert roads(mission).places == ("dock", "shelf", "v2", "lift L1", "lift L2", "lab")
    assert time(mission, "dock", "shelf") == 10.0  # 5 m at 0.5 m/s
    assert time(mission, "shelf", "v2") == 4.0  # a limit of 2 m/s makes nobody faster
    assert time(mission, "shelf", "dock") == 7.0  # one way: round the triangle
    assert time(mission, "dock", "lab") == 10 + 4 + 6 + 20 + 2
    assert roads(mission).times[GROUND][0][2] == math.inf  # no lane leads there


def test_chargers_are_where_robots_start_and_dispensers_are_tasks(tmp_path: Path) -> None:
    mission = rmf(tmp_path, GRAPH)
    assert isinstance(mission, tf.Mission)
    assert [(robot.name, robot.at) for robot in mission.robots] == [("ann", (0, 0))]
    assert [(task.name, task.at, task.note) for task in mission.tasks] == [
        ("pick up at shelf", (1, 0), "belt"),
        ("drop off at lab", (5, 0), "rack"),
    ]
    tree = copy.deepcopy(GRAPH)
    del tree["levels"]["L1"]["vertices"][0][2]["is_charger"]
    parked = rmf(tmp_path, tree)
    assert [(robot.name, robot.at) for robot in parked.robots] == [("robot-1", (5, 0))]


def test_the_office_of_open_rmf(tmp_path: Path) -> None:
    assert import_("rmf", SITES / "office.yaml", tmp_path / "office.yaml") == 0
    mission = read_mission(tmp_path / "office.yaml")
    assert [robot.name for robot in mission.robots] == ["tinyRobot1", "tinyRobot2"]
    assert [task.name for task in mission.tasks] == [
        "pick up at pantry",
        "drop off at coe",
        "drop off at hardware_2",
    ]
    tree = yaml.safe_load((SITES / "office.yaml").read_text())["levels"]["L1"]
    at = {said["name"]: (x, y) for x, y, said in tree["vertices"]}
    straight = math.dist(at["pantry"], at["patrol_D1"])
    assert time(mission, "pantry", "patrol_D1") == pytest.approx(straight, abs=5e-4)
    lanes = {(begin, end) for begin, end, _ in tree["lanes"]}
    rows = roads(mission).times[GROUND]
    ways = {(a, b) for a, row in enumerate(rows) for b, t in enumerate(row) if 0 < t < math.inf}
    assert ways == lanes


def test_lifts_lead_from_level_to_level_in_the_hotel_of_open_rmf() -> None:
    [site] = import_missions("rmf", SITES / "hotel.yaml")
    assert isinstance(site, Site)  # nothing in it says what is to be done
    assert [roads(site).name_of(robot.at) for robot in site.robots] == ["tinybot_charger"]
    up, down = time(site, "lobby", "L3_room1"), time(site, "L3_room1", "lobby")
    assert up == pytest.approx(down)
    assert 20 < up < 20 + 150


def test_a_site_without_tasks_becomes_a_file_to_complete(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "hotel.yaml"
    assert import_("rmf", SITES / "hotel.yaml", out) == 0
    assert "places: 55, robots: 1, tasks: 0; add tasks" in capsys.readouterr().err
    with pytest.raises(MissionError, match="there is no task; add one"):
        read_mission(out)
    more = "tasks:\n  - {at: lobby, needs: [carry]}\n"
    out.write_text(out.read_text().replace("tasks: []\n", more))
    assert read_mission(out).tasks[0].name == "t1"


def test_the_quickest_of_two_edges_counts_and_a_vehicle_starts_where_it_charges() -> None:
    [site] = import_missions("lif", SITES / "lif-12.json")
    assert time(site, "N0", "N1") == 5.0  # 5 m, limits 0.8 and 0.3 m/s for others
    assert time(site, "N1", "N0") == 6.25  # at 0.8 m/s
    assert [(robot.name, robot.at) for robot in site.robots] == [("Vehicle_Type_1-1", (0, 0))]


def test_edges_lead_from_layout_to_layout() -> None:
    [site] = import_missions("lif", SITES / "lif-14.json")
    assert time(site, "N2", "N102") == pytest.approx(math.hypot(1.4, 3.4), abs=5e-4)
    assert time(site, "N1", "N101") == pytest.approx(11 + math.hypot(1.4, 3.4) + 0.4, abs=1e-3)
    assert time(site, "N2", "N1") == math.inf


def test_a_curve_is_as_long_as_its_two_parabolas() -> None:
    """Its control points make two quadratic Bezier curves, which have a length in closed form."""
    [site] = import_missions("lif", SITES / "lif-17.json")
    parabola = 3.6 * (math.sqrt(2) + math.asinh(1)) / (2 * math.sqrt(2))
    assert time(site, "N1", "N2") == pytest.approx(2 * parabola, abs=5e-4)


def test_a_circle_of_weighted_points_is_as_long_as_a_circle(tmp_path: Path) -> None:
    tree = published(17)
    for edge in tree["layouts"][0]["edges"]:
        edge["vehicleTypeEdgeProperties"][0]["trajectory"] = {
            "degree": 2,
            "knotVector": [0, 0, 0, 1, 1, 1],
            "controlPoints": [
                {"x": 1, "y": 0},
                {"x": 1, "y": 1, "weight": math.sqrt(0.5)},
                {"x": 0, "y": 1},
            ],
        }
    assert time(lif(tmp_path, tree), "N1", "N2") == pytest.approx(math.pi / 2, abs=1e-3)


def test_stations_are_tasks_and_each_type_of_vehicle_has_its_own_roads(tmp_path: Path) -> None:
    tree = published(13)
    layout = tree["layouts"][0]
    for node in layout["nodes"]:
        node["vehicleTypeNodeProperties"].append({"vehicleTypeId": "tug"})
    layout["edges"][0]["vehicleTypeEdgeProperties"].append(
        {"vehicleTypeId": "tug", "rotationAllowed": False, "maxSpeed": 0.5}
    )
    layout["stations"].append({"stationId": "S1", "interactionNodeIds": ["N1"]})
    mission = lif(tmp_path, tree)
    assert isinstance(mission, tf.Mission)
    assert [(task.name, task.at) for task in mission.tasks] == [("S1", (1, 0))]
    assert [robot.moves for robot in mission.robots] == ["Vehicle_Type_1"]
    assert time(mission, "N_CHARGER", "N1", "Vehicle_Type_1") == 5.0
    assert time(mission, "N_CHARGER", "N1", "tug") == 10.0
    assert time(mission, "N1", "N_CHARGER", "tug") == math.inf


def test_a_type_of_vehicle_does_not_pass_nodes_that_do_not_name_it(tmp_path: Path) -> None:
    tree = published(13)
    tree["layouts"][0]["edges"][0]["vehicleTypeEdgeProperties"][0]["vehicleTypeId"] = "tug"
    assert time(lif(tmp_path, tree), "N_CHARGER", "N1") == math.inf


WRONG_GRAPHS = [
    (lambda t: t.pop("levels"), "lacks 'levels'"),
    (lambda t: t["levels"]["L1"]["lanes"].append([0, 4, {}]), r"lanes\[5\]\[1\] is 4, but this"),
    (lambda t: t["levels"]["L1"]["lanes"].append([0]), r"lanes\[5\] lacks entry 1"),
    (lambda t: t["levels"]["L2"]["vertices"][0].__setitem__(0, "x"), r"L2.vertices\[0\]\[0\] is"),
    (lambda t: t["levels"]["L1"]["vertices"][1].pop(), r"vertices\[1\] lacks entry 2"),
    (
        lambda t: t["levels"]["L1"]["lanes"][0][2].update(speed_limit=-1),
        r"lanes\[0\]\[2\].speed_limit is -1",
    ),
    (
        lambda t: t["levels"]["L1"]["lanes"].pop(0),
        "task 'pick up at shelf' cannot be reached",
    ),
]
WRONG_LAYOUTS = [
    (lambda t: t["metaInformation"].update(lifVersion="2.0.0"), "lifVersion is 2.0.0; versions"),
    (lambda t: t["layouts"][0]["edges"][0].update(endNodeId="N9"), "endNodeId is 'N9', which is"),
    (lambda t: t["layouts"][0]["nodes"][1].update(nodeId="N_CHARGER"), "as another node is"),
    (lambda t: t["layouts"][0].update(edges=[]), "has no edge that a vehicle may take"),
    (lambda t: t["layouts"][0]["stations"].append(t["layouts"][0]["stations"][0]), "another stati"),
    (
        lambda t: t["layouts"][0]["edges"][0]["vehicleTypeEdgeProperties"][0].update(maxSpeed=0),
        "maxSpeed is 0; here should be more than 0",
    ),
    (
        lambda t: t["layouts"][0]["edges"][0]["vehicleTypeEdgeProperties"][0].update(
            trajectory={"knotVector": [0, 1], "controlPoints": [{"x": 0, "y": 0}] * 2}
        ),
        "knotVector has 2 numbers; with 2 control points and degree 1 it needs 4",
    ),
]


@pytest.mark.parametrize(("spoil", "told"), WRONG_GRAPHS)
def test_what_is_wrong_with_a_graph_is_told(spoil: Any, told: str, tmp_path: Path) -> None:
    tree = copy.deepcopy(GRAPH)
    spoil(tree)
    with pytest.raises(TeamformerError, match=told) as raised:
        rmf(tmp_path, tree)
    assert "0.yaml: " in str(raised.value)
    assert raised.value.hint


@pytest.mark.parametrize(("spoil", "told"), WRONG_LAYOUTS)
def test_what_is_wrong_with_a_layout_is_told(spoil: Any, told: str, tmp_path: Path) -> None:
    tree = published(13)
    spoil(tree)
    with pytest.raises(TeamformerError, match=told) as raised:
        lif(tmp_path, tree)
    assert "site.lif.json: " in str(raised.value)
    assert raised.value.hint
