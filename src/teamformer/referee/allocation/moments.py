"""When orders, crews and shared plans are made, and why: whenever something happens, never else."""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass, field

from teamformer.referee.completion import Tasks
from teamformer.referee.verdict import Notes
from teamformer.sim.replay.record import Crew, Replay

START, APPEARED, TAKEN_OVER = "start", "task appeared", "taken over"


@dataclass(frozen=True)
class News:
    """What happened in a step that everybody is told of."""

    lost: Set[int] = frozenset()
    reasons: tuple[str, ...] = ()  # to plan anew, in the order in which records have them
    served: Mapping[int, Set[int]] = field(default_factory=dict)
    """The tasks that were being served after it, and by which robots."""


def judge_moments(
    replay: Replay, tasks: Tasks, news: Sequence[News], is_running: bool, notes: Notes
) -> None:
    """Check that orders, crews and plans were made after the steps after which they are.

    `news` has what happened in each step, the first at 0 being nothing; `is_running` says that the
    mission was not over after the last.
    """
    last, allocation = len(news) - 1, replay.mission.allocation
    told = range(last + 1 if is_running else last)  # who makes plans once all is over?
    _judge_orders(replay, tasks, last, notes)
    if allocation == "crews":
        made = {steps for steps, _ in replay.crews}
        _compare("are no crews", "are crews", made, _crew_moments(replay, tasks, news, told), notes)
    if allocation == "plan":
        due = _plan_reasons(replay, tasks, news, told)
        taken = {steps for steps, plan in replay.plans if TAKEN_OVER in plan.reasons}
        made = {steps for steps, _ in replay.plans}
        _compare("is no plan", "is a plan", made, set(due) | (taken & set(told)), notes)
        for steps, plan in replay.plans:
            more = (TAKEN_OVER,) if TAKEN_OVER in plan.reasons else ()
            wanted = (*due.get(steps, ()), *more)
            if steps in told and plan.reasons != wanted:
                why = ", ".join(wanted) or "nothing"
                notes.note(f"the plan made after {steps} steps says another reason than {why}")


def _judge_orders(replay: Replay, tasks: Tasks, last: int, notes: Notes) -> None:
    """Check that there is an order at the start, when tasks appear, and with crews and plans."""
    opened = {0, *tasks.openings()}
    made = {steps for steps, _ in replay.orders}
    for steps in sorted(opened - made):
        if steps <= last:
            notes.note(f"there is no order from after {steps} steps, when tasks appeared")
    for steps in sorted(step for step in made if step > last):
        notes.note(f"there is an order from after {steps} steps, but only {last} were made")
    planned = {steps for rows in (replay.crews, replay.plans) for steps, _ in rows}
    for steps in sorted(step for step in made - opened - planned if step <= last):
        notes.note(f"there is an order from after {steps} steps, when no task appeared")
    for steps in sorted(planned - made):
        notes.note(f"there is no order from after {steps} steps, when a plan was made")


def _compare(lacks: str, has: str, made: Set[int], due: Set[int], notes: Notes) -> None:
    for steps in sorted(due - made):
        notes.note(f"there {lacks} from after {steps} steps")
    for steps in sorted(made - due):
        notes.note(f"there {has} from after {steps} steps, when nothing happened to plan for")


def _plan_reasons(
    replay: Replay, tasks: Tasks, news: Sequence[News], told: Sequence[int]
) -> dict[int, tuple[str, ...]]:
    """Return why a shared plan is made after each of the steps after which one is."""
    opened = tasks.openings()
    first = min((steps for steps, _ in replay.plans), default=0)
    due = {}
    for steps in told:
        appeared = (START if steps <= first else APPEARED,) if steps in opened else ()
        if reasons := (*appeared, *news[steps].reasons):
            due[steps] = reasons
    return due


def _crew_moments(
    replay: Replay, tasks: Tasks, news: Sequence[News], told: Sequence[int]
) -> set[int]:
    """Return after which steps crews are planned.

    That is while tasks are open: if some appeared, a member of a crew was lost, a robot is back,
    needs or a place are known, or a crew has just done its last while another has several left.
    """
    crews, opened, due = dict(replay.crews), tasks.openings(), set[int]()
    now: Sequence[Crew] = ()
    members: set[int] = set()
    for steps in told:
        is_told = {"robot back", "needs known", "task found"} & set(news[steps].reasons)
        is_changed = bool(is_told) or not members.isdisjoint(news[steps].lost)
        members -= news[steps].lost
        is_due = steps in opened or is_changed or _is_any_idle(now, tasks, steps)
        if is_due and tasks.open_after(steps):
            due.add(steps)
        if steps in crews:
            now = crews[steps]
            members = {robot for crew in now for robot in crew.robots}
    return due


def _is_any_idle(crews: Sequence[Crew], tasks: Tasks, steps: int) -> bool:
    """Say whether a crew did its last task in a step, and another has more than one left."""
    crew_of = {task: number for number, crew in enumerate(crews) for task in crew.tasks}
    left = [crew_of.get(task) for task in tasks.open_after(steps)]
    has_several = len(set(left)) < len(left)
    did = {crew_of.get(task) for task, step in tasks.done.items() if step == steps}
    return has_several and not did <= set(left)
