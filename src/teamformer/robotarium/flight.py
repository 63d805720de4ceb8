"""A mission: real or simulated robots form teams and do the tasks of a mission.

Teams decide once a step by their own views. The rules of the environment say what follows from
decisions and from where the robots have got to; the controller moves the robots, tick by tick.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from teamformer.base.array_types import Array
from teamformer.methods.seam.protocol import Policy
from teamformer.mission.coordination import Coordinator
from teamformer.mission.model import Mission
from teamformer.mission.parts.plane import Plane
from teamformer.robotarium.control.barrier import Solver
from teamformer.robotarium.control.controller import Controller, Steering
from teamformer.robotarium.control.goals import Goals, Work, choose_goals
from teamformer.robotarium.control.teams import RobotTeam, teams_of
from teamformer.robotarium.places import team_places
from teamformer.robotarium.robots.arena import LONGEST, MIDDLE, TICK
from teamformer.robotarium.robots.plant import Robots
from teamformer.world.env import Decision, Tally, TeamFormation
from teamformer.world.rules.constants import NOBODY
from teamformer.world.view import View


@dataclass(frozen=True)
class Snapshot:
    """How a mission stood at a tick, for drawing."""

    tick: int
    poses: Array  # (robots, 3) in the arena's coordinates
    teams: tuple[RobotTeam, ...]
    is_open: Array  # (tasks,) known and not done
    is_done: Array  # (tasks,)


@dataclass(frozen=True)
class TickTimes:
    """What the clock of the processor said, in seconds: means, and the longest decision."""

    decision: float  # of all teams, with their views
    longest_decision: float  # without the first, in which code may be compiled
    tick: float  # filter and controller


@dataclass(frozen=True)
class FlightOutcome:
    """What came of a mission; `done_at` has the tick in which each task was done, or None."""

    tally: Tally
    ticks: int
    done_at: tuple[int | None, ...]
    timing: TickTimes

    @property
    def is_completed(self) -> bool:
        """Say whether all tasks were done."""
        return self.tally.status == "completed"


Watch = Callable[[Snapshot], None]


def as_flown(mission: Mission, steering: Steering) -> Mission:
    """Return a mission as the environment is to see it: with real paces and Robotarium's limit."""
    plane = mission.world
    assert isinstance(plane, Plane)
    step = ticks_per_step(plane) * TICK
    robots = (replace(r, speed=min(r.speed, steering.speed)) for r in mission.robots)
    return replace(
        mission,
        world=replace(plane, step=step),
        robots=tuple(robots),
        step_limit=min(mission.step_limit, int(LONGEST / step)),
    )


def ticks_per_step(plane: Plane) -> int:
    """Return how many ticks the teams act between two decisions."""
    return max(1, round(plane.step / TICK))


def fly(
    mission: Mission,
    policy: Policy | None,
    robots: Robots,
    solve: Solver,
    seed: int = 0,
    watch: Watch | None = None,
    coordinator: Coordinator | None = None,
) -> FlightOutcome:
    """Run a mission to its end; `watch` is called at every tick.

    A policy decides for the teams, or, without one, the plans of a coordinator do.
    """
    flight = _Mission(mission, policy, coordinator, robots, solve, seed)
    return flight.run(watch or (lambda moment: None))


class _Mission:
    """The state of a mission under way."""

    def __init__(
        self,
        mission: Mission,
        policy: Policy | None,
        coordinator: Coordinator | None,
        robots: Robots,
        solve: Solver,
        seed: int,
    ) -> None:
        steering = Steering()
        self._env = TeamFormation([as_flown(mission, steering)], coordinator=coordinator)
        self._policy = policy
        self._robots = robots
        self._controller = Controller(len(mission.robots), solve, steering)
        self._tasks = np.array([task.at for task in mission.tasks])  # (tasks, 2)
        worlds = self._env.worlds
        self._work = Work(self._tasks - MIDDLE, worlds.needs[0], worlds.brings[0])
        plane = mission.world
        assert isinstance(plane, Plane)
        self._radius, self._ticks_per_step = plane.arrival_radius, ticks_per_step(plane)
        self._ticks = 0
        self._under_way = np.zeros(len(mission.robots), dtype=np.int64)  # see choose_goals
        self._seconds: dict[str, list[float]] = {"decision": [], "tick": []}
        if policy is not None:
            policy.begin(None, np.random.default_rng(seed))

    def run(self, watch: Watch) -> FlightOutcome:
        """Decide, move and see what came of it until all is done or time is up."""
        poses = self._robots.poses()
        while self._env.is_running[0]:
            self._decide()
            teams = teams_of(self._env)
            goals = self._choose_goals(teams, poses[:, :2])
            for _ in range(self._ticks_per_step):
                watch(self._moment(poses, teams))
                self._robots.drive(self._steer(poses, goals))
                poses = self._robots.poses()
                self._ticks += 1
            places = team_places(teams, poses[:, :2], goals, self._tasks, self._radius)
            self._env.finish_step(places[None])
        watch(self._moment(poses, teams_of(self._env)))
        return self._outcome()

    def _wanted(self, view: View) -> Decision:
        """Return what the policy, or the plan, wants of the teams of a view."""
        if self._policy is None:
            return self._env.planned_decision(view)
        return self._policy.decide(view)

    def _moment(self, poses: Array, teams: list[RobotTeam]) -> Snapshot:
        is_done = self._env.worlds.tasks["done_at"][0] != NOBODY
        return Snapshot(self._ticks, poses, tuple(teams), self._is_open(), is_done)

    def _decide(self) -> None:
        """Let all teams decide, and carry out what they want."""
        begun = time.process_time()
        view = self._env.view()
        decision = self._wanted(view)
        self._seconds["decision"].append(time.process_time() - begun)
        self._env.start_step(decision)

    def _choose_goals(self, teams: list[RobotTeam], at: Array) -> Goals:
        goals = choose_goals(teams, at, self._work, self._is_open(), self._under_way)
        self._under_way = np.where(goals.keeps_clear, self._under_way + 1, 0)
        return goals

    def _steer(self, poses: Array, goals: Goals) -> Array:
        begun = time.process_time()
        velocities = self._controller.steer(poses, goals.way_points, goals.is_idle)
        self._seconds["tick"].append(time.process_time() - begun)
        return velocities

    def _is_open(self) -> Array:
        is_open: Array = self._env.worlds.tasks["is_open"][0].copy()
        return is_open

    def _outcome(self) -> FlightOutcome:
        steps = self._env.worlds.tasks["done_at"][0].tolist()
        deciding, ticking = self._seconds["decision"], self._seconds["tick"]
        return FlightOutcome(
            tally=self._env.tally(),
            ticks=self._ticks,
            done_at=tuple(s * self._ticks_per_step if s > 0 else None for s in steps),
            timing=TickTimes(
                decision=float(np.mean(deciding[1:] or deciding)),
                longest_decision=max(deciding[1:], default=0.0),
                tick=float(np.mean(ticking)),
            ),
        )
