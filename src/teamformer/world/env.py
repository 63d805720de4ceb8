"""The Team Formation Environment: a batch of worlds that are viewed and stepped together."""

from __future__ import annotations

import copy
import itertools
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.kernels.clock import working_seconds
from teamformer.mission.arrivals import with_arrivals
from teamformer.mission.checks.costs import cost_in_steps
from teamformer.mission.coordination import Coordinator, Known, Plan, heeded_by
from teamformer.mission.model import Mission
from teamformer.mission.parts.plane import DECIMALS
from teamformer.mission.truth import draw_truth
from teamformer.world.guidance.guide import Guide
from teamformer.world.guidance.known import known_of
from teamformer.world.phases.task_order import order_worlds
from teamformer.world.reward import Reward
from teamformer.world.rules.constants import NOBODY
from teamformer.world.state.arrays import RUNNING, STATUS_NAMES, Worlds
from teamformer.world.state.packing import pack_worlds
from teamformer.world.step import finish_worlds, form_worlds, step_worlds
from teamformer.world.view import View, fill_views, lay_out_rows, room_for_views


@dataclass(frozen=True)
class Decision:
    """What each deciding team wants: one row for each row of the view it answers.

    `wanted` (teams, caps) are the counts the team wants to have: its own to maintain, fewer to
    split, more to join. `task` (teams,), if given, names the task to head for; -1 leaves that to
    the allocator.
    """

    wanted: Array
    task: Array | None = None


@dataclass(frozen=True)
class Tally:
    """How a trial stands."""

    status: str  # running, completed, step limit or infeasible
    steps: int
    tasks_done: int
    joins: int
    splits: int
    illegal_decisions: int
    cost: float | None = None  # of a completed mission that has one


class TeamFormation:
    """Many worlds in one: `view()` what the teams know, `step(decision)` what they want.

    Missions of different sizes may be mixed. The same missions and decisions give the same
    results with any number of threads. `rewards` (worlds, robots) holds the rewards of the last
    step, by slot. `truths` says what uncertain missions really are; left out, it is drawn by the
    seed 0. With more than one thread, `close()` it, or use it in a `with`, to end them.

    With a `coordinator`, one for all worlds or one for each (None: without), teams go by its plans:
    `planned_decision(view)` is what these want. Without one, teams head for tasks by the paper's
    shared order and allocator; `new_tasks` says what becomes of the order when tasks appear: it is
    solved anew (`resolve`), or each goes after its nearest (`nearest`). `foresight` says how needs
    are treated that nobody knows yet: as `needed` or as `absent`; with `scouting` as likely, and
    places are looked for with a view to what may come.
    """

    def __init__(
        self,
        missions: Sequence[Mission],
        reward: Reward | None = None,
        threads: int = 1,
        truths: Sequence[Mission] | None = None,
        coordinator: Coordinator | Sequence[Coordinator | None] | None = None,
        new_tasks: str = "resolve",
        foresight: str = "scouting",
    ) -> None:
        self.missions = tuple(missions)
        if not self.missions:
            raise ValueError("there is no mission; give one or more")
        if threads < 1:
            raise ValueError(f"threads is {threads}; use 1 or more")
        drawn = (draw_truth(mission, 0) for mission in self.missions)
        self.truths = tuple(drawn if truths is None else truths)
        both = zip(self.missions, self.truths, strict=True)
        self.missions = tuple(with_arrivals(mission, truth) for mission, truth in both)
        coordinators = _for_each(coordinator, len(self.missions))
        is_coordinated = [coordinator is not None for coordinator in coordinators]
        self._rules = (new_tasks, foresight)
        self._start = pack_worlds(self.missions, self.truths, is_coordinated, *self._rules)
        self._has_order = not all(is_coordinated)
        self._guide = (
            Guide(self._start, self.missions, coordinators) if any(is_coordinated) else None
        )
        self.planning_seconds = 0.0  # of plans and orders
        self._bring_up_to_date(self._start)
        self.worlds = Worlds(*(array.copy() for array in self._start))
        self._first_guide = self._guide.fork() if self._guide else None
        reward = reward or Reward()
        self._weights = (reward.done, reward.step, reward.fit)
        count, robots, caps = self.worlds.has.shape
        self._room = room_for_views(self.worlds, self.missions)
        self._shown = self._room  # as many rows of it as the latest view had
        self._first_row = np.zeros(count + 1, dtype=np.int64)
        self._first_member = np.zeros(count + 1, dtype=np.int64)
        self._pool = ThreadPoolExecutor(threads) if threads > 1 else None
        edges = [count * thread // threads for thread in range(threads + 1)]
        self._chunks = list(itertools.pairwise(edges))
        self.rewards = np.zeros((count, robots))
        self._is_viewed = self._is_forked = False
        self._decided = np.zeros((0, caps), np.int32), np.zeros(0, np.int32)
        rules = self.worlds.rules
        moves = (rules["hides_places"] | rules["has_loads"]) & rules["has_walls"]
        self._are_ways_fixed = not moves.any()  # to a task elsewhere, or with a load, lead others

    def __enter__(self) -> TeamFormation:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __getstate__(self) -> dict[str, Any]:
        """Leave out the threads: a copy in another process has none, and the same results."""
        return vars(self) | {"_pool": None}

    def close(self) -> None:
        """End the threads; views and steps are then made without them."""
        if self._pool is not None:
            self._pool.shutdown()
            self._pool = None

    def reset(self) -> None:
        """Put every world back to its start."""
        for array, start in zip(self.worlds, self._start, strict=True):
            if not (self._are_ways_fixed and array is self.worlds.fields):
                array[:] = start
        self._guide = self._first_guide.fork() if self._first_guide else None
        self.rewards[:] = 0.0
        self._is_viewed = False

    def restart(self, w: int, mission: Mission, truth: Mission) -> None:
        """Put a world back to the start of a mission, the same as before or one of the same sizes.

        `truth` is what the mission really is. Raises ValueError for a mission of other sizes, for
        coordinated worlds, and where forks share the ways of worlds.
        """
        if self._guide is not None or (self._is_forked and self.worlds.fields.size):
            raise ValueError("worlds with a coordinator or with forks start again by reset()")
        mission = with_arrivals(mission, truth)
        packed = pack_worlds([mission], [truth], [False], *self._rules)
        self._bring_up_to_date(packed)
        for array, start, new in zip(self.worlds, self._start, packed, strict=True):
            if array.shape[1:] != new.shape[1:]:
                raise ValueError(f"the mission {mission.name} has other sizes than the world")
            array[w] = start[w] = new[0]
        self.missions = (*self.missions[:w], mission, *self.missions[w + 1 :])
        self.truths = (*self.truths[:w], truth, *self.truths[w + 1 :])
        self.rewards[w] = 0.0
        self._is_viewed = False

    def fork(self) -> TeamFormation:
        """Return another environment in the same state that goes its own way, without threads."""
        twin = copy.copy(self)
        shared = self.worlds.fields if self._are_ways_fixed else None
        twin.worlds = Worlds(*(a if a is shared else a.copy() for a in self.worlds))
        twin._room = twin._shown = View(*(part.copy() for part in self._room))
        twin._first_row, twin._first_member = self._first_row.copy(), self._first_member.copy()
        twin.rewards = self.rewards.copy()
        twin._guide = self._guide.fork() if self._guide else None
        twin._pool, twin._is_viewed = None, False
        self._is_forked = twin._is_forked = True
        return twin

    def view(self) -> View:
        """Return the views of all teams of the running worlds.

        The arrays are reused: they hold until the next call.
        """
        lay_out_rows(self.worlds, self._first_row, self._first_member)
        self._in_chunks(self._fill_views)
        self._is_viewed = True
        rows, members = int(self._first_row[-1]), int(self._first_member[-1])
        if (len(self._shown.slot), len(self._shown.member)) != (rows, members):
            short = {
                "first_member": self._room.first_member[: rows + 1],
                "member": self._room.member[:members],
                "member_counts": self._room.member_counts[:members],
            }
            fields = (short.get(f, getattr(self._room, f)[:rows]) for f in View._fields)
            self._shown = View(*fields)
        return self._shown

    def step(self, decision: Decision) -> None:
        """Make one step in every running world, with a row for each row of the latest view.

        Raises ValueError where the state has changed since that view, and where the decision has
        other rows, fractions, or counts that 32 bits cannot hold.
        """
        wanted, named = self._read(decision)
        self._in_chunks(lambda begin, end: self._step_worlds(wanted, named, begin, end))
        self._bring_up_to_date(self.worlds)

    def start_step(self, decision: Decision) -> None:
        """Make the phases of a step before motion: decisions, splits, joins and allocation.

        For motion from outside, such as that of real robots: they go where `worlds.teams` says
        (its `task`; for a joiner, whose `intent` is JOIN, its `partner`), and `finish_step` ends
        the step with where they have got to.
        """
        if self.worlds.rules["has_batteries"].any():
            raise ValueError("who charges where is up to the step: robots with batteries step()")
        wanted, named = self._read(decision)
        form_worlds(self.worlds, wanted, named, self._first_row)

    def finish_step(self, places: Array) -> None:
        """Make the phases after motion, with every team at its row of `places`.

        `places` (worlds, robots, 2) has the place of each team at its slot; other rows mean
        nothing. On a plane what lies outside counts as at its edge.
        """
        if places.shape != (*self.rewards.shape, 2):
            raise ValueError(f"places has {places.shape}, not {(*self.rewards.shape, 2)}")
        if not np.isfinite(places[self.worlds.teams["size"] > 0]).all():
            raise ValueError("places has no finite place for some team")
        corners = np.array([mission.world.corner for mission in self.missions])
        inside = np.clip(np.round(places, DECIMALS), 0.0, corners[:, None])
        finish_worlds(self.worlds, inside, self._weights, self.rewards)
        self._bring_up_to_date(self.worlds)

    @property
    def is_coordinated(self) -> Array:
        """Return which worlds have a coordinator, as (worlds,)."""
        return np.asarray(self.worlds.rules["is_coordinated"])

    def planned_decision(self, view: View) -> Decision:
        """Return what the plans of coordinators want of each team of a view."""
        return Decision(self._guided.wanted(view.world, view.slot))

    def known(self, w: int = 0) -> Known:
        """Return what everybody knows of a world now."""
        return known_of(self.worlds, w, self.missions[w], 0)

    def plan(self, w: int = 0) -> Plan:
        """Return the plan that a coordinated world goes by now."""
        return self._guided.plan(self.worlds, w)

    def plans(self, w: int = 0) -> tuple[tuple[int, Plan], ...]:
        """Return all plans of a world so far, each with the steps made when it was; or none."""
        return tuple(self._guide.plans[w]) if self._guide else ()

    def heeds(self, w: int = 0) -> tuple[str, ...]:
        """Return the news after which a world's coordinator is asked; none without one."""
        coordinator = self._guide.coordinators[w] if self._guide else None
        return () if coordinator is None else heeded_by(coordinator)

    def ends(self, w: int = 0) -> dict[int, int]:
        """Return the step in which each task of a world was done that was, by number."""
        done_at = self.worlds.tasks["done_at"][w]
        return {task: int(done_at[task]) for task in np.flatnonzero(done_at != NOBODY).tolist()}

    def called_off(self, w: int = 0) -> frozenset[int]:
        """Return the tasks of a world that were called off, by number."""
        tasks, steps = self.worlds.tasks[w], self.worlds.count["steps"][w]
        is_over = (tasks["done_at"] != NOBODY) | (tasks["missed_at"] != NOBODY)
        return frozenset(np.flatnonzero((tasks["cancelled"] <= steps) & ~is_over).tolist())

    def missed(self, w: int = 0) -> dict[int, int]:
        """Return the step after which each task of a world was missed that was, by number."""
        missed_at = self.worlds.tasks["missed_at"][w]
        return {task: int(missed_at[task]) for task in np.flatnonzero(missed_at != NOBODY).tolist()}

    def decided(self) -> tuple[Array, Array]:
        """Return what the teams wanted in the latest step, (teams, caps), and named, (teams,).

        There is a row for each team that there was before it, in world and slot order.
        """
        return self._decided

    def exchanges(self) -> Array:
        """Return the robot whose part of the first world's plan each has just taken, (robots,)."""
        if self._guide is None:
            return np.full(self.worlds.robots.shape[1], NOBODY)
        return self._guide.parts.took[0]

    def take_over_plan(self, plan: Plan) -> None:
        """Let the teams of the first world, a coordinated one, go by a plan from now on.

        It holds until there is news after which the coordinator makes a new one.
        """
        self._guided.take_over(self.worlds, 0, plan)

    @property
    def _guided(self) -> Guide:
        if self._guide is None:
            raise ValueError("these worlds have no coordinator; give one")
        return self._guide

    def _bring_up_to_date(self, worlds: Worlds) -> None:
        """Have orders and plans made where there is news."""
        begun = working_seconds()
        if self._has_order and worlds.count["arrived"].any():
            order_worlds(worlds)
        if self._guide is not None:
            self._guide.update(worlds)
        self.planning_seconds += working_seconds() - begun

    def _read(self, decision: Decision) -> tuple[Array, Array]:
        """Return what the teams want and name, as the kernels take it."""
        if not self._is_viewed:
            raise ValueError("the state has changed since the latest view: call view() first")
        read = read_decision(decision, int(self._first_row[-1]), self.worlds.has.shape[2])
        self._is_viewed, self._decided = False, read
        return read

    @property
    def is_running(self) -> Array:
        """Return which worlds go on, as (worlds,)."""
        return np.asarray(self.worlds.count["status"] == RUNNING)

    def tally(self, w: int = 0) -> Tally:
        """Return how one world stands."""
        count, status = self.worlds.count[w], STATUS_NAMES[self.worlds.count[w]["status"]]
        return Tally(
            status=status,
            steps=int(count["steps"]),
            tasks_done=int(count["done"]),
            joins=int(count["joins"]),
            splits=int(count["splits"]),
            illegal_decisions=int(count["illegal"]),
            cost=self._cost(w) if status == "completed" else None,
        )

    def _cost(self, w: int) -> float | None:
        steps = int(self.worlds.count["steps"][w])
        return cost_in_steps(self.truths[w], self.ends(w), steps, self.called_off(w))

    def _fill_views(self, begin: int, end: int) -> None:
        fill_views(self.worlds, self._room, self._first_row, self._first_member, begin, end)

    def _step_worlds(self, wanted: Array, named: Array, begin: int, end: int) -> None:
        rows, weights = self._first_row, self._weights
        step_worlds(self.worlds, wanted, named, rows, weights, self.rewards, begin, end)

    def _in_chunks(self, work: Callable[[int, int], None]) -> None:
        if self._pool is None:
            work(0, len(self.missions))
        else:
            list(self._pool.map(work, *zip(*self._chunks, strict=True)))


def _for_each(
    coordinator: Coordinator | Sequence[Coordinator | None] | None, count: int
) -> list[Coordinator | None]:
    """Return a coordinator, or None, for each world."""
    if not isinstance(coordinator, Sequence):
        return [coordinator] * count
    if len(coordinator) != count:
        raise ValueError(f"there are {len(coordinator)} coordinators for {count} missions")
    return list(coordinator)


def read_decision(decision: Decision, rows: int, caps: int) -> tuple[Array, Array]:
    """Return what teams want, (rows, caps), and the tasks that they name, (rows,), for kernels.

    Raises ValueError where the decision has other rows, fractions, or counts that 32 bits cannot
    hold.
    """
    if rows == 0 and len(decision.wanted) == 0:  # nobody is left until somebody is back
        return np.zeros((0, caps), np.int32), np.zeros(0, np.int32)
    task = np.full(rows, NOBODY, np.int32) if decision.task is None else decision.task
    wanted = _whole("wanted", decision.wanted, np.dtype(np.int32))
    named = _whole("task", task, np.dtype(np.int32))
    if wanted.shape != (rows, caps) or named.shape != (rows,):
        raise ValueError(
            f"the latest view asks for wanted ({rows}, {caps}) and task ({rows},); "
            f"the decision has {wanted.shape} and {named.shape}"
        )
    return wanted, named


def _whole(name: str, values: Array, dtype: np.dtype[Any]) -> Array:
    """Return an array of whole numbers as a kernel takes it; ValueError if it cannot hold them."""
    given = np.asarray(values)
    if given.dtype != dtype:
        if given.dtype.kind not in "biuf":
            raise ValueError(f"{name} holds {given.dtype}; use whole numbers")
        with np.errstate(invalid="ignore"):
            whole = given.astype(dtype)
        if not np.array_equal(whole, given):
            raise ValueError(f"{name} holds what is no whole number of {8 * dtype.itemsize} bits")
        given = whole
    return np.ascontiguousarray(given)
