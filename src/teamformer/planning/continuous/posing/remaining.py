"""Some robots and tasks of a mission at a moment: what its problem and its clock are made of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from teamformer.base.array_types import Floats, Int32s, Ints
from teamformer.mission.coordination import Known
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Place
from teamformer.planning.continuous.posing.batteries import by_ability
from teamformer.planning.continuous.posing.tables import longest_of, ways_by_pace, ways_home
from teamformer.planning.problem.relaxed_problem import count_table, least_carried
from teamformer.planning.problem.rotas import longest_pauses
from teamformer.planning.problem.ways import ends_of
from teamformer.world.rules.starts import Gap, RoomLeft
from teamformer.world.rules.waits import Waits, waits_at


@dataclass(frozen=True)
class Remaining:
    """Robots and tasks by their numbers in the mission; in all else by their places in these.

    Places are where tasks end, then depots: where robots are, and from when on. Times are those of
    the mission, and how long something takes.
    """

    known: Known
    robots: tuple[int, ...]
    tasks: tuple[int, ...]
    places: Sequence[Place]
    site: Int32s  # (places,) the same for places at one position
    origin: Sequence[int]  # (robots,) the place where each is
    ready: Sequence[float]  # (depots,) how long until who is there can leave
    pace: Ints  # (robots,)
    ways: Floats  # (paces, places, tasks)
    carry: Floats  # (paces, tasks) how long loads are carried
    home: Floats  # (robots, places)
    counts: Int32s  # (robots, caps)
    needs: Int32s  # (tasks, caps)
    carried: Floats  # (tasks,) how long the fastest coalition carries
    takes: Floats  # (tasks,) how long each takes with that one
    release: Sequence[float]  # (tasks,)
    latest: Sequence[float]  # (tasks,) by when each is to start because of one that has begun
    before: Mapping[int, Sequence[int]]
    gaps: Sequence[Gap]
    rooms: Sequence[RoomLeft]

    @property
    def mission(self) -> Mission:
        """Return the mission as it is believed to be."""
        return self.known.mission

    @cached_property
    def own_robots(self) -> list[Robot]:
        """Return what the mission says of the robots."""
        return [self.mission.robots[robot] for robot in self.robots]

    @cached_property
    def own_tasks(self) -> list[Task]:
        """Return what the mission says of the tasks."""
        return [self.mission.tasks[task] for task in self.tasks]

    @cached_property
    def free(self) -> list[float]:
        """Return when each robot can leave its place, (robots,)."""
        return [self.known.free_at[robot] for robot in self.robots]

    @property
    def busy(self) -> float:
        """Return how long all takes at most, one task after the other."""
        own = self.own_tasks, self.mission.forming, self.ways, self.home, self.carry
        return longest_of(*own) + max(self.ready, default=0.0)

    @property
    def longest_wait(self) -> float:
        """Return how long all waits at most beside, about."""
        now = self.known.now
        rotas = [rota.counted_from(now) for rota in dict.fromkeys(r.rota for r in self.own_robots)]
        opens = max((begin - now for begin in self.release), default=0.0)
        return opens + longest_pauses(rotas, self.busy, len(self.tasks))


def remaining_at(known: Known, numbers: Sequence[int], chosen: Sequence[int]) -> Remaining:
    """Return some robots and tasks, both by their numbers, as they are at a moment."""
    mission, now = known.mission, known.now
    robots = [mission.robots[robot] for robot in numbers]
    tasks = [mission.tasks[task] for task in chosen]
    depot_of = [(known.places[r], known.free_at[r] - now, known.came_from[r]) for r in numbers]
    depots = list(dict.fromkeys(depot_of))
    places = [*ends_of(tasks), *(place for place, _, _ in depots)]
    sites = [*ends_of(tasks), *(came_from for _, _, came_from in depots)]
    pace, ways, carry = ways_by_pace(mission, robots, tasks, places)
    counts = count_table([robot.can for robot in robots], mission)
    needs = count_table([task.needs for task in tasks], mission)
    counts, needs = by_ability(mission, numbers, chosen, counts, needs)
    carried = np.array([least_carried(counts, carry[pace, k], needs[k]) for k in range(len(tasks))])
    waits = waits_at(known, chosen)
    number_of = {task: number for number, task in enumerate(chosen)}
    before, gaps = _renumbered(waits, number_of)
    return Remaining(
        known=known,
        robots=tuple(numbers),
        tasks=tuple(chosen),
        places=places,
        site=np.unique(np.array(sites, np.float64), axis=0, return_inverse=True)[1]
        .ravel()
        .astype(np.int32),
        origin=[len(tasks) + depots.index(depot) for depot in depot_of],
        ready=[left for _, left, _ in depots],
        pace=pace,
        ways=ways,
        carry=carry,
        home=ways_home(mission, robots, places),
        counts=counts,
        needs=needs,
        carried=carried,
        takes=np.array([task.duration + task.unload for task in tasks]) + carried,
        release=[waits.release[task] for task in chosen],
        latest=[waits.latest[task] for task in chosen],
        before=before,
        gaps=gaps,
        rooms=[
            room._replace(
                tasks=frozenset(number_of[task] for task in room.tasks),
                loads=frozenset(number_of[task] for task in room.loads),
            )
            for room in waits.rooms
        ],
    )


def _renumbered(
    waits: Waits, number_of: Mapping[int, int]
) -> tuple[dict[int, list[int]], list[Gap]]:
    """Return the tasks before each and the gaps between starts, in the numbers of a problem."""
    before = {number_of[k]: [number_of[o] for o in others] for k, others in waits.before.items()}
    gaps = [
        gap._replace(task=number_of[gap.task], other=number_of[gap.other]) for gap in waits.gaps
    ]
    return before, gaps
