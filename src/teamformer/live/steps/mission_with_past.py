"""A mission step by step, whose past stays as it was when incidents happen.

An incident changes the mission: a task that appears now, a task called off or a robot lost or back
in the next step.
The changed mission is then played again up to now with the decisions and plans that were made, so
that nothing is planned but what follows from now on, and the record is at every moment what `run`
makes of the mission with all its incidents. Of what was recorded, only
the assignments after the latest step may change: whoever learns of a task thinks anew.

Two incidents bring a plan: one that is taken over, and another weight of a task. The record holds
such a plan. `run` makes plans of its own.

Before each incident the mission is kept as it stands, so that the latest incident can be undone.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

from teamformer.base.errors import TeamformerError
from teamformer.live.running.incidents import (
    Happening,
    Incident,
    NewWeight,
    Present,
    mission_after,
    plan_of,
)
from teamformer.live.steps.futures import PastInSteps, replayed
from teamformer.methods.by_name import Method
from teamformer.methods.coordinators.reordered import Reordered
from teamformer.methods.coordinators.replayed import Replayed
from teamformer.methods.seam.protocol import Planner
from teamformer.mission.coordination import Coordinator, Plan
from teamformer.mission.model import Mission
from teamformer.mission.truth import draw_truth
from teamformer.planning.bounds.makespan import lower_bound
from teamformer.record.files.writing import step_to_tree
from teamformer.record.record import Record, Step
from teamformer.trials.recorder import Recorder
from teamformer.trials.trial import begin, decide
from teamformer.world.env import Decision, Tally, TeamFormation

MakeMethod = Callable[[], Method]


class _Standing(NamedTuple):
    """A mission as it stands: what an incident changes, and what undoing it brings back."""

    env: TeamFormation
    recorder: Recorder
    source: Mission
    bound: int | None


class RunningMission:
    """One mission that runs by one method; `incidents` are what happened so far, with steps.

    `plans` were made before, with the steps made then; they are not made again. `make_method`
    makes the method anew: forecasts play with one of their own. Under a method that knows
    everything the mission is what an uncertain one really is.
    """

    def __init__(
        self,
        mission: Mission,
        make_method: MakeMethod,
        seed: int,
        plans: Sequence[tuple[float, Plan]] = (),
    ) -> None:
        if make_method().needs_everything:
            mission = draw_truth(mission, seed)
        self.source, self.seed = mission, seed
        self.incidents: list[tuple[float, Happening]] = []
        self.drawn = mission  # before anything happened
        self._make_method = make_method
        self._method = self._begin()
        if self._method.coordinator is not None:
            coordinator = Replayed(plans, self._method.coordinator)
            self._method = replace(self._method, coordinator=coordinator)
        self.method_name = self._method.name
        self._decisions: list[Decision] = []
        self._env = self._stage(mission, self._method.coordinator)
        self._recorder = Recorder(self._env)
        self._bound: int | None = None
        self._before: list[_Standing] = []  # by incident

    def anew(self) -> RunningMission:
        """Return the same mission before its first step, to which nothing has happened."""
        return RunningMission(self.drawn, self._make_method, self.seed)

    @property
    def steps(self) -> int:
        """Return how many steps have been made."""
        return self.tally().steps

    @property
    def now(self) -> float:
        """Return how many steps have been made."""
        return self.steps

    @property
    def status(self) -> str:
        """Return `running`, or how the mission has ended."""
        return self.tally().status

    @property
    def is_running(self) -> bool:
        """Say whether there is a next step."""
        return bool(self._env.is_running[0])

    @property
    def latest(self) -> dict[str, Any]:
        """Return what the latest step changed, as autosaves have it."""
        return {"step": step_to_tree(self._recorder.latest)}

    @property
    def latest_plans(self) -> list[tuple[float, Plan]]:
        """Return the plans that were made since the step before the latest."""
        return [(made, plan) for made, plan in self._env.plans() if made == self.steps]

    @property
    def truth(self) -> Mission:
        """Return what the mission really is, with all that has happened to it."""
        return self._env.truths[0]

    def tally(self) -> Tally:
        """Return how the mission stands."""
        return self._env.tally()

    def ends(self) -> dict[int, int]:
        """Return the step in which each task was done that was, by number."""
        return self._env.ends()

    def usual_speed(self, speed: float) -> float:
        """Return the steps a second to begin with."""
        return speed

    def beat(self, speed: float) -> tuple[float, float]:
        """Return how many seconds there are between two steps at so many steps a second; a step."""
        return 1 / speed, 1.0

    def move(self, units: float | None = None) -> None:
        """Make a step."""
        self.step()

    def again(self, latest: dict[str, Any]) -> dict[str, Any]:
        """Make a step again, and return what it has changed; nothing if there is none to make.

        Raises KeyError for what is not told of a step.
        """
        if latest["step"] is None or not self.is_running:
            return {}
        self.step()
        return self.latest

    @property
    def has_shown_more(self) -> bool:
        """Say whether the latest step has told something of an uncertain mission."""
        if not self.source.has_surprises:
            return False
        latest = self._recorder.latest
        shown = latest.shown or latest.found or latest.moved or latest.done
        tasks = self._env.missions[0].tasks
        has_arrived = any(it.has_arrived and it.appears == self.steps for it in tasks)
        return bool(shown or latest.lost or latest.back or has_arrived)

    def step(self) -> Step:
        """Make one step and return what it changed."""
        decision = _copied(decide(self._env, self._method, self._env.view()))
        self._env.step(decision)
        self._decisions.append(decision)
        self._recorder.step()
        return self._recorder.latest

    def happen(self, incident: Happening) -> None:
        """Let an incident happen now; TeamformerError says why it cannot, and nothing changes."""
        incident, env, recorder, mission = self._changed(incident)
        before = _Standing(self._env, self._recorder, self.source, self._bound)
        self.incidents.append((self.steps, incident))
        self._before.append(before)
        self._env, self._recorder = env, recorder
        if mission is not self.source:
            self.source, self._bound = mission, None

    def undo(self) -> Happening:
        """Go back to just before the latest incident, and return it; the steps since are undone.

        Raises TeamformerError if nothing has happened.
        """
        if not self.incidents:
            raise TeamformerError("nothing has happened that could be undone")
        _, incident = self.incidents.pop()
        self._env, self._recorder, self.source, self._bound = self._before.pop()
        del self._decisions[self.steps :]
        return incident

    def mission_with(self, happening: Happening) -> Mission:
        """Return the mission if something happened now; nothing is planned or played for it."""
        planner = self.method_name if self._method.needs_everything else None
        return mission_after(happening, self.source, self._present(), planner)

    def work_out_bound(self) -> int | None:
        """Return the steps that no plan can beat, as `run` tells them; the record has them then."""
        mission = self.source
        if self._bound is None:
            bound = lower_bound(draw_truth(mission, self.seed))
            if self.source is not mission:  # an incident has happened meanwhile
                return None
            self._bound = bound
        return self._bound

    def record(self) -> Record:
        """Return the record so far; that of a mission that still runs is of an interrupted one."""
        return self._recorder.finish(self.method_name, self.seed, self._bound)

    def as_it_stands(self) -> RunningMission:
        """Return the mission as it is now, to be asked about while it goes on itself.

        It makes no steps and nothing happens to it.
        """
        now = copy.copy(self)
        now.incidents, now._decisions = list(self.incidents), list(self._decisions)
        now._env, now._recorder = self._env.fork(), copy.copy(self._recorder)
        return now

    def past(self) -> PastInSteps:
        """Return the present and how it came about, to play it ahead while the mission goes on."""
        plans = _plans_of(self.incidents)
        return PastInSteps(
            self.source, self._env.fork(), self._begin, tuple(self._decisions), plans
        )

    @property
    def is_planned(self) -> bool:
        """Say whether robots go by plans of a coordinator, which searches for them."""
        return self._method.coordinator is not None

    def past_planned_anew(self, order: int) -> PastInSteps:
        """Return the present with a plan that is made now, in another order of robots and tasks."""
        known = replace(self._env.known(), news=("task appeared",))
        plan = self._coordinator(order).update(known, self._env.plan())
        return self.past().with_plan(plan)

    def past_with(self, incident: Incident, order: int = 0) -> PastInSteps:
        """Return the present as it would be if an incident happened now.

        What then follows is planned in an order of robots and tasks.
        """
        happening, env, _, mission = self._changed(incident, order)
        plans = _plans_of([*self.incidents, (self.steps, happening)])
        return PastInSteps(mission, env, self._begin, tuple(self._decisions), plans)

    def _present(self) -> Present:
        is_planned = bool(self._env.is_coordinated[0])
        return Present(self.steps, self.steps + 1, self.truth, self.ends(), is_planned)

    def _begin(self) -> Method:
        method = self._make_method()
        begin(method, [self.source], [self.source], self.seed)
        return method

    def _stage(self, mission: Mission, coordinator: Coordinator | None) -> TeamFormation:
        """Return the mission before its first step; a planner brings its own coordinator."""
        policy = self._method.policy
        if isinstance(policy, Planner):
            coordinator = policy.plans[0].coordinator
        truth = draw_truth(mission, self.seed)
        return TeamFormation([mission], truths=[truth], coordinator=coordinator)

    def _coordinator(self, order: int = 0) -> Coordinator:
        assert self._method.coordinator is not None, "refused where robots follow no plan"
        coordinator = self._method.coordinator
        return Reordered(coordinator, order) if order else coordinator

    def _changed(
        self, happening: Happening, order: int = 0
    ) -> tuple[Happening, TeamFormation, Recorder, Mission]:
        """Return what happens, with its plan, and the mission as it would stand if it did now."""
        mission = self.mission_with(happening)
        if isinstance(happening, NewWeight) and happening.plan is None:
            happening = happening.planned(
                self._env.known(), self._env.plan(), self._coordinator(order)
            )
        coordinator = self._coordinator(order) if self.is_planned else None
        env = self._stage(mission, replayed(self._env, coordinator))
        recorder = Recorder(env)
        plans = _plans_of([*self.incidents, (self.steps, happening)])
        for made, decision in enumerate([*self._decisions, None]):
            for plan in (plan for steps, plan in plans if steps == made):
                env.take_over_plan(plan)
                recorder.replan()
            if decision is not None:
                env.view()
                env.step(decision)
                recorder.step()
        if not _is_same_past(recorder.finish(self.method_name, self.seed, None), self.record()):
            raise TeamformerError("this would change what has been; it has not happened")
        return happening, env, recorder, mission


def _plans_of(incidents: Sequence[tuple[float, Happening]]) -> list[tuple[int, Plan]]:
    """Return the plans that incidents brought, with the steps made then."""
    plans = ((int(steps), plan_of(happening)) for steps, happening in incidents)
    return [(steps, plan) for steps, plan in plans if plan is not None]


def _is_same_past(one: Record, other: Record) -> bool:
    """Say whether the same was done; a task that appears takes assignments back in that step."""
    if one.steps[:-1] != other.steps[:-1]:
        return False
    return [_deeds(step) for step in one.steps[-1:]] == [_deeds(step) for step in other.steps[-1:]]


def _deeds(step: Step) -> tuple[object, ...]:
    """Return what a step did, without what teams then headed for."""
    return step.joins, step.splits, step.lost, step.back, step.done


def _copied(decision: Decision) -> Decision:
    """Return a decision of its own: policies may reuse their arrays."""
    task = None if decision.task is None else decision.task.copy()
    return Decision(decision.wanted.copy(), task)
