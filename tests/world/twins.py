"""The compiled step and the reference step side by side, compared after every step."""

from __future__ import annotations

import numpy as np
import pytest

from teamformer.mission.checks.rules import FORESIGHTS
from teamformer.world.env import Decision, TeamFormation
from teamformer.world.reference.carrying import steps_to_go
from teamformer.world.reference.completion import give_up, may_give_up, status_of
from teamformer.world.reference.following import PlainPlan, follow_plan
from teamformer.world.reference.state import PlainTeam, PlainWorld, Units, Wish
from teamformer.world.reference.step import begin, make_step
from teamformer.world.rules.constants import NOBODY
from teamformer.world.view import View


class Twin:
    """The first world of an environment, played again by the reference step."""

    def __init__(self, env: TeamFormation) -> None:
        is_coordinated = bool(env.is_coordinated[0])
        foresight = FORESIGHTS[env.worlds.rules["foresight"][0]]
        self.env, self.plans_made = env, 0
        self.world: PlainWorld = begin(env.missions[0], env.truths[0], is_coordinated, foresight)
        self.plan = PlainPlan((), ())
        self.wants: dict[int, Units] = {}
        self.overdue = 0
        self._take_over_order_and_plan()
        self.compare()

    def step(self, view: View, decision: Decision) -> None:
        """Make a step in both, and compare them; before it, what the plan wants of teams."""
        slots, world = view.slot.tolist(), self.world
        if world.is_coordinated:
            planned = dict(zip(slots, self.env.planned_decision(view).wanted.tolist(), strict=True))
            own = {slot: team.has for slot, team in world.teams.items()}
            assert {slot: tuple(counts) for slot, counts in planned.items()} == own | self.wants
        happened = make_step(world, wishes_of(slots, decision))
        self.overdue += happened.any_overdue
        self.env.step(decision)
        is_given_up = self._is_given_up()
        self.compare(is_given_up)
        if is_given_up:
            self._take_over_order_and_plan()
            assert status_of(world) == "running"
            assert may_give_up(world)
            give_up(world)
        assert self.env.missed() == world.missed
        assert status_of(world) == self.env.tally().status
        if status_of(world) == "running":
            self._take_over_order_and_plan()

    def _is_given_up(self) -> bool:
        """Say whether the plan leaves out all that the reference step has left open."""
        return self.env.missed().keys() > self.world.missed.keys()

    def _take_over_order_and_plan(self) -> None:
        order = self.env.worlds.order[0, : self.env.worlds.count["open"][0]].tolist()
        assert set(order) == self.world.shared_out()
        self.world.order = order
        if self.world.is_coordinated:
            plans = self.env.plans()
            if is_new := len(plans) > self.plans_made:
                _, plan = plans[-1]
                self.plan = PlainPlan(plan.order, plan.coalitions, plan.scouts)
                self.plans_made = len(plans)
            self.wants, took = follow_plan(self.world, self.plan, is_new)
            exchanged = enumerate(self.env.exchanges().tolist())
            assert is_new or took == [pair for pair in exchanged if pair[1] > pair[0]]
            following = [NOBODY if task is None else task for task in self.world.next]
            assert following == self.env.worlds.robots["next"][0].tolist()

    def compare(self, is_given_up: bool = False) -> None:
        """Compare who is together where, with what, heading where; and all of the tasks."""
        worlds, world = self.env.worlds, self.world
        teams, tasks = worlds.teams[0], worlds.tasks[0]
        assert sorted(np.flatnonzero(teams["size"]).tolist()) == sorted(world.teams)
        for slot, team in world.teams.items():
            record = teams[slot]
            assert np.flatnonzero(worlds.robots["team"][0] == slot).tolist() == [*team.robots]
            assert (record["x"], record["y"]) == team.at
            assert record["task"] == (NOBODY if team.task is None else team.task)
            pursued = NOBODY if team.pursued is None else team.pursued
            assert record["pursued"] == pursued or world.steps == 0
            assert bool(record["is_detour"]) == team.is_detour
            assert record["charger"] == (NOBODY if team.charger is None else team.charger)
            assert record["serves"] == len(team.serving)
            assert record["credit"] == pytest.approx(team.credit, abs=1e-6)
            assert worlds.has[0, slot].tolist() == [*team.has]
        assert when(tasks["done_at"]) == world.done
        is_open = set(np.flatnonzero(tasks["is_open"]).tolist())
        assert is_open == (set() if is_given_up else world.open)
        assert set(np.flatnonzero(tasks["is_carried"]).tolist()) == world.carried
        assert worlds.count["cancelled"][0] == len(world.cancelled)
        assert list(zip(tasks["x"], tasks["y"], strict=True)) == world.at
        assert [tuple(counts) for counts in worlds.needs[0].tolist()] == world.needs
        for key, now in (("shown_at", world.happened.shown), ("found_at", world.happened.found)):
            assert [task for task, step in when(tasks[key]).items() if step == world.steps] == now
        robots = worlds.robots[0]
        for robot, left in world.left.items():
            assert robots["left"][robot] == pytest.approx(left, abs=1e-9)
            assert robots["charges"][robot] == (robot in world.charging)
        tally = self.env.tally()
        assert (tally.joins, tally.splits) == (world.joins, world.splits)
        assert tally.illegal_decisions == world.illegal

    def check_rests(self, view: View) -> None:
        """Compare for how long teams are expected to serve."""
        rests = {slot: int(rest) for slot, rest in zip(view.slot, view.rest, strict=True)}
        assert rests == {slot: rest(self.world, team) for slot, team in self.world.teams.items()}


def wishes_of(slots: list[int], decision: Decision) -> dict[int, Wish]:
    """Return the wishes of teams as the reference step takes them, by slot."""
    named = np.full(len(slots), NOBODY) if decision.task is None else np.asarray(decision.task)
    rows = zip(slots, np.asarray(decision.wanted).tolist(), named.tolist(), strict=True)
    return {
        slot: Wish(tuple(counts), None if task == NOBODY else task) for slot, counts, task in rows
    }


def when(steps: np.ndarray) -> dict[int, int]:
    """Return the step of each task that has one, by number."""
    return {task: step for task, step in enumerate(steps.tolist()) if step != NOBODY}


def rest(world: PlainWorld, team: PlainTeam) -> int:
    """Return for how long a team is expected to serve."""
    return max((_rest_of(world, team, task) for task in team.serving), default=0)


def _rest_of(world: PlainWorld, team: PlainTeam, task: int) -> int:
    wanted, left = world.mission.tasks[task], team.serving[task]
    loading = world.due.get(task, 0) - (int(world.truth.tasks[task].duration) - left)
    if wanted.to is None:
        return loading
    if task not in world.carried:
        return loading + steps_to_go(world, team, wanted.to, team.credit) + int(wanted.unload)
    if world.is_same(team.at, wanted.to):
        return left
    return steps_to_go(world, team, wanted.to, team.credit) + left - 1
