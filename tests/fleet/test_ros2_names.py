"""What `--body nav2:...` names, and where places of a mission are in a ROS map; without ROS."""

from __future__ import annotations

import math
from pathlib import Path
from unittest.mock import patch

import pytest

from fleets import pair
from teamformer.base.errors import TeamformerError
from teamformer.files.mission_files import write_mission
from teamformer.fleet.bodies.ros2.address import RosAddress, read_address
from teamformer.fleet.bodies.ros2.coordinates import metres_of, place_of
from teamformer.mission.parts.frame import Frame
from teamformer.mission.parts.grid import Grid
from teamformer.mission.parts.plane import Plane
from typed import teamformer


def test_the_namespace_is_the_robots_name_by_default() -> None:
    assert read_address("", "r1") == RosAddress("/r1", "map", "odom", "", 0.5, "")
    assert read_address("/fleet/r1?radius=0.4&odom=/odom&frame=world", "x").namespace == "/fleet/r1"
    address = read_address("fleet/r1?radius=0.4&odom=/odom&frame=world&serve=work", "no name!")
    assert address == RosAddress("/fleet/r1", "world", "/odom", "", 0.4, "work")
    assert (address.topic("odom"), address.topic("/odom")) == ("/fleet/r1/odom", "/odom")
    assert read_address("/", "r1").topic("goal_pose") == "/goal_pose"


@pytest.mark.parametrize(
    ("text", "robot", "told"),
    [
        ("", "r-1", "the robot's name 'r-1' is no ROS namespace"),
        ("1r", "r1", "'1r' is no ROS namespace"),
        ("a//b", "r1", "'a//b' is no ROS namespace"),
        ("r\u00e9", "r1", "is no ROS namespace"),
        ("r1?speed=2", "r1", "has no 'speed'"),
        ("r1?radius=0", "r1", "radius '0' is no length above 0"),
        ("r1?radius=nan", "r1", "radius 'nan' is no length"),
        ("r1?radius=near", "r1", "radius 'near' is no length"),
        ("r1?odom=", "r1", "odom '' is no ROS name"),
        ("r1?odom=a b", "r1", "odom 'a b' is no ROS name"),
    ],
)
def test_what_ros_does_not_allow_is_refused(text: str, robot: str, told: str) -> None:
    with pytest.raises(TeamformerError, match="--body nav2") as error:
        read_address(text, robot)
    assert told in str(error.value)
    assert error.value.hint


def test_a_frame_is_undone() -> None:
    """Cells of half a metre, turned by a quarter: [2, 0] is 1.25 m up from the corner."""
    frame = Frame(0.5, 10.0, 20.0, math.pi / 2)
    assert frame.point((2, 0)) == pytest.approx((9.75, 21.25))
    assert frame.place((9.75, 21.25)) == pytest.approx((2.0, 0.0))
    assert frame.place((10.0, 20.0)) == pytest.approx((-0.5, -0.5))


def test_places_become_metres_and_back() -> None:
    plane = Plane(20.0, 20.0)
    assert metres_of(plane, (3.5, 4.0)) == (3.5, 4.0)
    assert place_of(plane, 3.5, 4.0) == (3.5, 4.0)
    bare = Grid(5, 4)
    assert metres_of(bare, (2, 1)) == (2.0, 1.0)
    assert place_of(bare, 2.4, 0.6) == (2, 1)
    mapped = Grid(5, 4, frame=Frame(0.1, 1.0, 2.0))
    assert metres_of(mapped, (2, 1)) == pytest.approx((1.25, 2.15))
    assert place_of(mapped, 1.24, 2.16) == (2, 1)


def test_who_stands_at_a_wall_is_in_the_nearest_free_cell() -> None:
    """The middle column is blocked: .#. with the robot just inside of it, towards the right."""
    walled = Grid(3, 1, rows=(".#.",))
    assert place_of(walled, 1.2, 0.0) == (2, 0)
    assert place_of(walled, 0.9, 0.0) == (0, 0)
    assert place_of(walled, 40.0, 0.0) == (40, 0)
    assert not walled.is_free((40, 0))


@pytest.mark.parametrize(
    ("body", "told"),
    [
        ("nav3", "there is no body 'nav3'"),
        ("nav2:r-1", "'r-1' is no ROS namespace"),
        ("nav2:r1?odometry=x", "--body nav2 has no 'odometry'"),
    ],
)
def test_the_command_line_tells_it(
    body: str, told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert agent_with(body, tmp_path) == 2
    words = capsys.readouterr().err
    assert told in words
    assert "hint: " in words


def test_a_python_without_ros_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from teamformer.fleet.process import our_bodies

    with patch.object(our_bodies, "find_spec", lambda _: None):
        assert agent_with("nav2", tmp_path) == 2
    words = capsys.readouterr().err
    assert "error: --body nav2 needs ROS 2: this Python has no rclpy" in words
    assert "docs/how-to/ros2.md" in words


def agent_with(body: str, folder: Path) -> int:
    write_mission(pair().source, folder / "pair.yaml")
    words = ("fleet", "agent", str(folder / "pair.yaml"), "r0", "--body", body)
    return teamformer(*words, "--listen", "tcp/127.0.0.1:1")
