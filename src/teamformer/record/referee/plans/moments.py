"""When orders and plans are made, and why: whenever something happens, never else."""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass, field

from teamformer.record.record import Record
from teamformer.record.referee.rules.completion import Tasks
from teamformer.record.referee.rules.verdict import Notes

START, APPEARED, TAKEN_OVER = "start", "task appeared", "taken over"


@dataclass(frozen=True)
class News:
    """What happened in a step that everybody is told of."""

    lost: Set[int] = frozenset()
    reasons: tuple[str, ...] = ()  # to plan anew, in the order in which records have them
    served: Mapping[int, Set[int]] = field(default_factory=dict)
    """The tasks that were being served after it, and by which robots."""


def judge_moments(
    record: Record, tasks: Tasks, news: Sequence[News], is_running: bool, notes: Notes
) -> None:
    """Check that orders and plans were made after the steps after which they are.

    `news` has what happened in each step, the first at 0 being nothing; `is_running` says that the
    mission was not over after the last.
    """
    last = len(news) - 1
    told = range(last + 1 if is_running else last)  # who makes plans once all is over?
    _judge_orders(record, tasks, last, notes)
    if record.is_coordinated:
        due = _plan_reasons(record, tasks, news, told)
        taken = {steps for steps, plan in record.plans if TAKEN_OVER in plan.reasons}
        made = {steps for steps, _ in record.plans}
        _compare(made, set(due) | (taken & set(told)), notes)
        for steps, plan in record.plans:
            more = (TAKEN_OVER,) if TAKEN_OVER in plan.reasons else ()
            wanted = (*due.get(steps, ()), *more)
            if steps in told and plan.reasons != wanted:
                why = ", ".join(wanted) or "nothing"
                notes.note(f"the plan made after {steps} steps says another reason than {why}")


def _judge_orders(record: Record, tasks: Tasks, last: int, notes: Notes) -> None:
    """Check that there is an order at the start, when tasks appear, and with plans."""
    opened = {0, *tasks.arrivals()}
    made = {steps for steps, _ in record.orders}
    for steps in sorted(opened - made):
        if steps <= last:
            notes.note(f"there is no order from after {steps} steps, when tasks appeared")
    for steps in sorted(step for step in made if step > last):
        notes.note(f"there is an order from after {steps} steps, but only {last} were made")
    planned = {steps for steps, _ in record.plans}
    for steps in sorted(step for step in made - opened - planned if step <= last):
        notes.note(f"there is an order from after {steps} steps, when no task appeared")
    for steps in sorted(planned - made):
        notes.note(f"there is no order from after {steps} steps, when a plan was made")


def _compare(made: Set[int], due: Set[int], notes: Notes) -> None:
    for steps in sorted(due - made):
        notes.note(f"there is no plan from after {steps} steps")
    for steps in sorted(made - due):
        notes.note(f"there is a plan from after {steps} steps, when nothing happened to plan for")


def _left_out(record: Record, tasks: Tasks) -> set[int]:
    """Return after how many steps a task may begin, after others, that nobody is planned to do."""
    orders, left_out = dict(record.orders), set[int]()
    for task, wanted in enumerate(record.mission.tasks):
        opens = tasks.opens_after(task) if wanted.after else None
        made = [row for row in record.plans if opens is not None and row[0] < opens]
        if opens is None or not made:
            continue
        steps, plan = made[-1]
        robots_of = dict(zip(orders.get(steps, ()), plan.coalitions, strict=False))
        if not robots_of.get(task):
            left_out.add(opens)
    return left_out


def _plan_reasons(
    record: Record, tasks: Tasks, news: Sequence[News], told: Sequence[int]
) -> dict[int, tuple[str, ...]]:
    """Return why a plan is made after each of the steps after which one is."""
    opened = tasks.arrivals() | _left_out(record, tasks)
    due = {}
    for steps in told:
        first = (START,) if steps == 0 else (APPEARED,) if steps in opened else ()
        heard = tuple(
            why for why in (*first, *news[steps].reasons) if why in (START, *record.heeds)
        )
        if heard:
            due[steps] = heard
    return due
