"""Agents drive robots of a ROS 2 graph, by the real rclpy; `make test-ros` installs it."""

from __future__ import annotations

import math
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("rclpy", reason="needs rclpy: `make test-ros` installs it and runs this")

import rclpy
from action_msgs.msg import GoalStatus
from geometry_msgs.msg import PoseStamped
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from test_msgs.action import Fibonacci
from visualization_msgs.msg import Marker, MarkerArray

from teamformer.base.errors import TeamformerError
from teamformer.files.mission_files import write_mission
from teamformer.fleet.agent.planning import first_plan
from teamformer.fleet.bodies.body import Command
from teamformer.fleet.bodies.ros2.address import read_address
from teamformer.fleet.bodies.ros2.body import Nav2Body
from teamformer.fleet.bodies.ros2.goals import ByAction, GoalState, pose_at
from teamformer.fleet.bodies.ros2.graph import RosNode, Whereabouts
from teamformer.fleet.bodies.ros2.markers import BLUE, GREEN, GREY, WAY, Markers
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.planner import CoordinatedPlanner
from teamformer.fleet.process.facts_file import FactsFile
from teamformer.fleet.process.fleet import free_ports
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.plane import Plane

pytestmark = pytest.mark.filterwarnings("ignore:module 'sre_:DeprecationWarning")  # of rosidl

ROBOT = Path(__file__).parent / "ros_robot.py"


def yard() -> FleetMission:
    """Return two lifters and a scanner, with tasks for one and tasks for both kinds."""
    robots = (
        Robot("r1", (1.0, 1.0), {"lift": 1}, 2.0),
        Robot("r2", (11.0, 1.0), {"scan": 1}, 2.0),
        Robot("r3", (18.0, 18.0), {"lift": 1}, 2.0),
    )
    tasks = (
        Task("both", (6.0, 4.0), {"lift": 1, "scan": 1}, 2),
        Task("look", (9.0, 3.0), {"scan": 1}, 1),
        Task("near", (2.0, 3.0), {"lift": 1}, 1),
        Task("far", (18.0, 10.0), {"lift": 1}, 1),
        Task("end", (10.0, 8.0), {"lift": 1, "scan": 1}, 1),
    )
    return FleetMission(Mission("yard", Plane(20.0, 20.0), ("lift", "scan"), robots, tasks))


@contextmanager
def running(command: list[str], log: Path) -> Iterator[subprocess.Popen[bytes]]:
    with log.open("wb") as out:
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=out, stderr=out)
    try:
        yield process
    finally:
        process.terminate()
        try:
            process.wait(10)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def robot_node(mission: FleetMission, number: int, folder: Path, name: str = "") -> list[str]:
    robot = mission.source.robots[number]
    x, y = robot.at
    goals = folder / f"{robot.name}.goals"
    goals.touch()
    return [sys.executable, str(ROBOT), f"/{name or robot.name}", str(x), str(y), "2", str(goals)]


def until(holds: Callable[[], Any], seconds: float = 20.0) -> None:
    """Wait until something holds; fail if it never does."""
    deadline = time.monotonic() + seconds
    while not holds():
        assert time.monotonic() < deadline, "it never came"
        time.sleep(0.05)


@pytest.fixture(autouse=True)
def domain(monkeypatch: pytest.MonkeyPatch) -> None:
    """Keep to this machine, and to a graph that other tests do not use."""
    monkeypatch.setenv("ROS_DOMAIN_ID", str(1 + os.getpid() % 100))
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")


def test_a_robot_drives_serves_and_stops(tmp_path: Path) -> None:
    mission = yard()
    with running(robot_node(mission, 0, tmp_path), tmp_path / "robot.log"):
        body = Nav2Body(read_address("", "r1"), mission, 0)
        try:
            first = body.report()
            assert first is not None
            assert (first.x, first.y) == (1.0, 1.0)
            body.command(Command(1, (4.0, 5.0), 0))
            until(lambda: body.report()[:3] == (4.0, 5.0, 1))
            assert not body.report().has_served
            begun = time.monotonic()
            body.command(Command(1, (4.0, 5.0), 0, 0, True, 1.0))
            until(lambda: body.report().has_served)
            assert time.monotonic() - begun >= 1.0
            body.command(Command(2, (4.0, 15.0), 1))  # serves no more, and is on its way
            assert not body.report().has_served
            until(lambda: body.report().y > 7.0)
            body.command(Command(3))
            until(lambda: len((tmp_path / "r1.goals").read_text().split("\n")) == 4)
            there = body.report()
            time.sleep(1.0)
            after = body.report()
            assert math.dist(there[:2], after[:2]) < 0.5
            assert after.leg == 3
            assert after.number > first.number
        finally:
            body.close()
    goals = (tmp_path / "r1.goals").read_text().splitlines()
    assert goals[:2] == ["map 4 5", "map 4 15"]
    assert len(goals) >= 3  # the third is where it was told to stay


def test_a_goal_that_nobody_takes_up_is_sent_again(tmp_path: Path) -> None:
    """The robot node starts to listen to goals only after the first one was published."""
    mission = yard()
    address = read_address("late?odom=/odom", "r1")
    with running(robot_node(mission, 0, tmp_path, "other"), tmp_path / "other.log"):
        with pytest.raises(TeamformerError, match="no odometry from /odom within"):
            Nav2Body(address, mission, 0)
        body = Nav2Body(read_address("late?odom=/other/odom", "r1"), mission, 0)
        heard: list[PoseStamped] = []
        graph = RosNode("/late")
        try:
            body.command(Command(1, (4.0, 5.0), 0))
            graph.node.create_subscription(PoseStamped, "goal_pose", heard.append, 10)

            def is_heard() -> bool:
                body.report()
                return bool(heard)

            until(is_heard)
            assert (heard[0].pose.position.x, heard[0].pose.position.y) == (4.0, 5.0)
            yaw = 2 * math.atan2(heard[0].pose.orientation.z, heard[0].pose.orientation.w)
            assert yaw == pytest.approx(math.atan2(4.0, 3.0))
        finally:
            graph.close()
            body.close()


def test_rviz_is_shown_tasks_and_the_way(tmp_path: Path) -> None:
    """Task 4 is at [10, 8]; the robot stands at [1, 1] and is told to go there, then to stay."""
    mission, shown = yard(), list[dict[int, Any]]()
    graph = RosNode("/r1")
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    graph.node.create_subscription(
        MarkerArray,
        "mission",
        lambda array: shown.append({marker.id: marker for marker in array.markers}),
        latched,
    )
    try:
        markers = Markers(graph.node, mission, 0, "map")
        markers.show((1.0, 1.0), Command(1, (10.0, 8.0), 4))
        until(lambda: len(shown) == 1)
        markers.show((1.0, 1.0), Command(1, (10.0, 8.0), 4))  # nothing new
        markers.show((1.0, 1.0), Command(2, None, 4, 0, True))
        until(lambda: len(shown) == 2)
    finally:
        graph.close()
    first, last = shown
    assert len(first) == 2 * 5 + 2
    assert (first[8].pose.position.x, first[8].pose.position.y) == (10.0, 8.0)
    assert [first[2 * number + 1].text for number in range(5)] == [
        task.name for task in mission.tasks
    ]
    assert [(point.x, point.y) for point in first[WAY].points] == [(1.0, 1.0), (10.0, 8.0)]
    assert first[8].color.b == pytest.approx(BLUE[2])
    assert last[8].color.g == pytest.approx(GREEN[1])
    assert first[6].color.r == last[6].color.r == pytest.approx(GREY[0])
    assert (first[WAY].action, last[WAY].action) == (Marker.ADD, Marker.DELETE)


def test_a_graph_without_the_robot_is_told(tmp_path: Path) -> None:
    mission = yard()
    graph = RosNode("/r1")
    try:
        where = Whereabouts(graph, read_address("", "r1"))
        with pytest.raises(TeamformerError, match=r"no odometry from /r1/odom within 1 s") as told:
            where.wait(1.0)
        assert "ROS_DOMAIN_ID" in str(told.value.hint)
        with running(robot_node(mission, 0, tmp_path, "r9"), tmp_path / "robot.log"):
            until(lambda: "there is /r9/odom" in where._hint())
        pose = Whereabouts(graph, read_address("?pose=amcl_pose", "r1"))
        with pytest.raises(TeamformerError, match=r"no pose from /r1/amcl_pose within 0.5 s"):
            pose.wait(0.5)
    finally:
        graph.close()


def test_an_agent_without_its_robot_ends_with_a_hint(tmp_path: Path) -> None:
    write_mission(yard().source, tmp_path / "yard.yaml")
    command = [
        sys.executable,
        "-m",
        "teamformer.cli",
        "fleet",
        "agent",
        str(tmp_path / "yard.yaml"),
    ]
    command += ["r1", "--body", "nav2", "--listen", f"tcp/127.0.0.1:{free_ports(1)[0]}"]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert ended.returncode == 2
    assert "error: no odometry from /r1/odom within 10 s\n" in ended.stderr
    assert "Traceback" not in ended.stderr


class Server:
    """An action server: order 0 is aborted, 1 waits until it is cancelled, 9 is rejected."""

    def __init__(self) -> None:
        self.context = rclpy.Context()
        rclpy.init(context=self.context)
        self.node = Node("server", namespace="/r1", context=self.context)
        self.cancelled: list[int] = []
        group = ReentrantCallbackGroup()
        self.server = ActionServer(
            self.node,
            Fibonacci,
            "navigate_to_pose",
            self.execute,
            callback_group=group,
            goal_callback=lambda goal: (
                GoalResponse.REJECT if goal.order == 9 else GoalResponse.ACCEPT
            ),
            cancel_callback=lambda _: CancelResponse.ACCEPT,
        )
        self.executor = MultiThreadedExecutor(4, context=self.context)
        self.executor.add_node(self.node)
        self.thread = threading.Thread(target=self.executor.spin, daemon=True)
        self.thread.start()

    def execute(self, handle: ServerGoalHandle) -> Fibonacci.Result:
        order = handle.request.order
        if order == 0:
            handle.abort()
        elif order == 1:
            while not handle.is_cancel_requested:
                time.sleep(0.02)
            self.cancelled.append(order)
            handle.canceled()
        else:
            handle.succeed()
        return Fibonacci.Result()

    def close(self) -> None:
        self.executor.shutdown()
        self.thread.join(2)
        self.server.destroy()
        self.node.destroy_node()
        self.context.try_shutdown()


def test_goals_go_through_an_action_server() -> None:
    """The plumbing of NavigateToPose: the goal of each pose is its x as a Fibonacci order."""
    graph = RosNode("/r1")
    goals = ByAction(
        graph.node, Fibonacci, lambda pose: Fibonacci.Goal(order=int(pose.pose.position.x))
    )
    stamp = graph.node.get_clock().now().to_msg()

    def send(order: int) -> None:
        goals.go(pose_at("map", float(order), 0.0, 0.0, stamp))

    send(5)
    assert goals.state == GoalState.FAILED  # there is no server yet
    server = Server()
    try:
        assert goals.client.wait_for_server(10.0)
        for order, state in ((5, GoalState.ENDED), (0, GoalState.FAILED), (9, GoalState.FAILED)):
            send(order)
            until(lambda state=state: goals.state == state)
        send(1)
        until(lambda: goals.state == GoalState.GOING)
        send(7)  # takes the place of the one that is on
        until(lambda: goals.state == GoalState.ENDED and server.cancelled == [1])
        send(1)
        until(lambda: goals.state == GoalState.GOING)
        goals.stop(pose_at("map", 0.0, 0.0, 0.0, stamp))
        until(lambda: server.cancelled == [1, 1])
        time.sleep(0.3)
        assert goals.state == GoalState.ENDED
    finally:
        graph.close()
        server.close()
    assert GoalStatus.STATUS_SUCCEEDED == 4


@pytest.mark.slow
@pytest.mark.parametrize("is_mind_killed", [True, False], ids=["robot-and-agent", "robot"])
def test_a_fleet_in_a_ros_graph_survives_the_loss_of_one(
    is_mind_killed: bool, tmp_path: Path
) -> None:
    """Three robots, two tasks that need two of them; r3 is killed on its way to a third."""
    mission = yard()
    write_mission(mission.source, tmp_path / "yard.yaml")
    first_plan(mission, CoordinatedPlanner())  # so that no agent has to compile what plans
    ports = free_ports(3)
    names = [robot.name for robot in mission.source.robots]
    with ExitStack() as stack:
        nodes, agents = [], []
        for number, name in enumerate(names):
            node = running(robot_node(mission, number, tmp_path), tmp_path / f"{name}.robot.log")
            nodes.append(stack.enter_context(node))
        for number, name in enumerate(names):
            command = [sys.executable, "-m", "teamformer.cli", "fleet", "agent"]
            command += [str(tmp_path / "yard.yaml"), name, "--body", "nav2"]
            command += ["--listen", f"tcp/127.0.0.1:{ports[number]}"]
            command += ["--facts", str(tmp_path / name)]
            for port in ports[:number]:
                command += ["--connect", f"tcp/127.0.0.1:{port}"]
            agents.append(stack.enter_context(running(command, tmp_path / f"{name}.log")))
        goals = tmp_path / "r3.goals"
        until(lambda: "map 18 10" in goals.read_text(), 120)
        for process in (nodes[2], agents[2])[: 1 + is_mind_killed]:
            process.send_signal(signal.SIGKILL)
        files = [FactsFile(tmp_path / name, mission.number, n) for n, name in enumerate(names)]

        def done() -> list[set[int]]:
            kept = [file.read() for file in files[:2]]
            return [set(each.done) if each else set() for each in kept]

        until(lambda: done() == [{0, 1, 2, 3, 4}] * 2, 180)
    told = {name: (tmp_path / f"{name}.log").read_text() for name in names}
    if folder := os.environ.get("ROS_LOGS"):  # to look at
        for name, text in told.items():
            (Path(folder) / f"{name}.log").write_text(text)
    assert "r3 is lost" in told["r1"] + told["r2"]
    assert "both done with r2" in told["r1"] or "both done with r1" in told["r2"]
    assert "publishes goals on /r1/goal_pose" in told["r1"]
    assert "map 18 10" in (tmp_path / "r1.goals").read_text()  # what r3 was lost on the way to
    silent = "nothing is heard from /r3/odom any more" in told["r3"]
    assert silent == (not is_mind_killed)
    assert not any("Traceback" in text for text in told.values())
