"""A mission in steps played ahead: its past is played again under each truth that could be.

Where the past comes out as it did, the mission is played to its end.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from teamformer.live.running.forecasts import IsOver, Played
from teamformer.methods.by_name import Method
from teamformer.methods.coordinators.replayed import Replayed
from teamformer.mission.arrivals import once_appeared
from teamformer.mission.coordination import Coordinator, Plan
from teamformer.mission.model import Absence, Mission, Robot, Task
from teamformer.mission.parts.grid import Grid, Place
from teamformer.mission.truth import draw_absences, draw_truth
from teamformer.planning.steps.longer_search import search_longer
from teamformer.trials.trial import decide
from teamformer.world.env import Decision, TeamFormation
from teamformer.world.rules.constants import NOBODY


@dataclass(frozen=True)
class PastInSteps:
    """The present of a mission in steps, and how it came about."""

    mission: Mission
    env: TeamFormation
    begin: Callable[[], Method]
    decisions: Sequence[Decision]
    plans: Sequence[tuple[int, Plan]]  # taken over after so many steps

    @property
    def tasks(self) -> tuple[int, int]:
        """Return how many tasks there are but for those that are to appear yet, and with these."""
        return _tasks_known(self.env), len(self.env.missions[0].tasks)

    @property
    def is_planned(self) -> bool:
        """Say whether robots go by plans of a coordinator."""
        return bool(self.env.is_coordinated[0])

    def play_ahead(self, is_over: IsOver) -> Played:
        """Play to the end, or until nobody wants to know any more."""
        env, method = self.env.fork(), self.begin()
        while env.is_running[0] and not is_over():
            env.step(decide(env, method, env.view()))
        ends = env.worlds.tasks["done_at"][0].tolist()
        done_at = [None if step == NOBODY else step for step in ends]
        return Played(env.tally().status, env.tally().steps, done_at)

    def future(self, seed: int) -> PastInSteps | None:
        """Return the present under a truth that is drawn; None if the past would be another."""
        env = _future(self, seed)
        return None if env is None else replace(self, env=env)

    def with_plan(self, plan: Plan) -> PastInSteps:
        """Return the same if a plan were taken over now."""
        env, steps = self.env.fork(), self.env.tally().steps
        env.take_over_plan(plan)
        return replace(self, env=env, plans=(*self.plans, (steps, plan)))

    def search_plan(self, seconds: float, seed: int, is_over: IsOver) -> Plan:
        """Search for a better plan from the present on, as `central` does."""
        return search_longer(self.env.known(), self.env.plan(), seconds, seed, is_over)


def replayed(env: TeamFormation, coordinator: Coordinator | None) -> Coordinator | None:
    """Return a coordinator that gives the plans of an environment again while the same happens."""
    return None if coordinator is None else Replayed(env.plans(), coordinator)


def _tasks_known(env: TeamFormation) -> int:
    """Return how many tasks there are but for those that are to appear at random yet.

    They are the last.
    """
    steps, tasks = env.tally().steps, env.missions[0].tasks
    return sum(not task.has_arrived or task.appears <= steps for task in tasks)


def _future(past: PastInSteps, seed: int) -> TeamFormation | None:
    """Return the present under a truth that is drawn; None if the past would have been another."""
    truth = possible_truth(past.mission, past.env, seed)
    coordinator = replayed(past.env, past.begin().coordinator)
    env = TeamFormation([past.mission], truths=[truth], coordinator=coordinator)
    for made, decision in enumerate([*past.decisions, None]):
        for plan in (plan for steps, plan in past.plans if steps == made):
            env.take_over_plan(plan)
        if decision is None:
            break
        view = env.view()
        if not env.is_running[0] or len(view.slot) != len(decision.wanted):
            return None
        env.step(decision)
    if not _looks_alike(env, past.env):
        return None
    luck = env.worlds.robots["luck"]  # who stands still from now on, nobody knows
    luck[:] = np.random.default_rng(seed).integers(1, 2**63, size=luck.shape)
    return env


def _looks_alike(one: TeamFormation, other: TeamFormation) -> bool:
    """Say whether two environments stand alike, as far as anybody can see."""
    fields = {
        "teams": ("x", "y", "size", "serves"),
        "tasks": ("is_open", "served", "done_at", "shown_at", "found_at", "x", "y"),
        "robots": ("team",),
    }
    known = {"tasks": _tasks_known(other)}
    return all(
        np.array_equal(
            getattr(one.worlds, part)[name][:, : known.get(part)],
            getattr(other.worlds, part)[name][:, : known.get(part)],
        )
        for part, names in fields.items()
        for name in names
    )


def possible_truth(mission: Mission, env: TeamFormation, seed: int) -> Mission:
    """Draw a truth that could be behind what has been seen in an environment so far."""
    drawn, known = draw_truth(mission, seed), env.truths[0]
    rng, steps = np.random.default_rng(seed), env.tally().steps
    seen = env.worlds.tasks[0]
    tasks = (
        _possible_task(task, other, real, seen[number], _places_left(env, number), rng)
        for number, (task, other, real) in enumerate(
            zip(mission.tasks, drawn.tasks, known.tasks, strict=False)  # these have no arrivals
        )
    )
    now = once_appeared(mission, known, steps)
    arrived = known.tasks[len(mission.tasks) : len(now.tasks)]
    later = draw_truth(now, seed).tasks[len(now.tasks) :]
    robots = (
        _possible_robot(mission, robot, real, steps, rng)
        for robot, real in zip(mission.robots, known.robots, strict=True)
    )
    return replace(drawn, tasks=(*tasks, *arrived, *later), robots=tuple(robots))


def _possible_task(
    task: Task,
    drawn: Task,
    real: Task,
    seen: np.void,
    places: Sequence[Place],
    rng: np.random.Generator,
) -> Task:
    """Return a task as it could be.

    Where it is once it is found, else in one of the places left; what it needs once that is shown;
    how long it takes once it is done, or its load taken up.
    """
    at = drawn.at
    if task.within:
        at = real.at if seen["found_at"] != NOBODY else places[int(rng.integers(len(places)))]
    needs = real.needs if seen["shown_at"] != NOBODY else drawn.needs
    duration = drawn.duration
    if seen["done_at"] != NOBODY or seen["taken_at"] != NOBODY:
        duration = real.duration
    elif task.lasts is not None and seen["served"] > 0:
        shortest, longest = map(int, task.lasts)
        duration = int(rng.integers(max(shortest, seen["served"] + 1), longest + 1))
    return task.once_known(at, needs, duration)


def _places_left(env: TeamFormation, task: int) -> list[Place]:
    """Return where a task may be whose place is not known."""
    along = int if isinstance(env.missions[0].world, Grid) else float
    spots = env.worlds.spots[0]
    left = spots[task][spots[task]["is_possible"]] if len(spots) else ()
    return [(along(spot["x"]), along(spot["y"])) for spot in left]


def _possible_robot(
    mission: Mission, robot: Robot, real: Robot, steps: int, rng: np.random.Generator
) -> Robot:
    """Return a robot as it could be: lost and back when it was, and later when nobody knows."""
    if robot.breaks is None:
        return real
    been = [away for away in real.absences if away.lost <= steps]
    if been and been[-1].back is None:
        return replace(real, absences=tuple(been))
    sound_from = steps
    if been and robot.breaks.repair is not None and (been[-1].back or 0) > steps:
        lost, (shortest, longest) = int(been[-1].lost), map(int, robot.breaks.repair)
        least = max(shortest, steps + 1 - lost)
        sound_from = lost + int(rng.integers(least, longest, endpoint=True))
        been[-1] = Absence(been[-1].lost, sound_from)
    later = draw_absences(robot.breaks, mission.step_limit, rng, sound_from)
    return replace(real, absences=(*been, *later))
