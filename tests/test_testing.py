"""The checks that are shipped: ours pass them, and each fault is told by what it breaks."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from small_worlds import two_robots_one_task
from teamformer.files.drawn.named_settings import world_of
from teamformer.fleet.bodies.body import Command, Report
from teamformer.methods.coordinators.crews import Crews
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.methods.scripted.joining import JoinAll
from teamformer.mission.coordination import Known, Plan
from teamformer.testing import check_body, check_coordinator, check_policy
from teamformer.world.env import Decision

ROOT = Path(__file__).parents[1]


def class_of(page: str, before: str, name: str) -> Any:
    """Return a class that a page shows."""
    text = (ROOT / "docs" / page).read_text(encoding="utf-8")
    found: dict[str, Any] = {}
    exec(text.split(before)[1].split("```")[0], found)
    return found[name]


@pytest.mark.parametrize("make", [SharedPlan, Crews])
def test_our_coordinators_pass(make: Any) -> None:
    check_coordinator(make, [world_of(setting, 0) for setting in ("4N9T-C4", "warehouse-lost")])


def test_the_classes_of_the_documents_pass() -> None:
    check_coordinator(
        class_of("reference/coordinators.md", '```python title="mine.py"\n', "Soonest")
    )
    check_policy(class_of("reference/policies.md", '```python title="sociable.py"\n', "Sociable"))
    check_body(class_of("how-to/robots.md", "```python\n", "MyBody"), seconds=1.0)


class Silent:
    def update(self, known: Known, plan: Plan | None) -> Any:
        return None


class Lazy:
    def update(self, known: Known, plan: Plan | None) -> Plan:
        return Plan()


class Impossible:
    def update(self, known: Known, plan: Plan | None) -> Plan:
        return Plan((99,), ((0,),))


class Counting(Crews):
    heeds = ("start", "gossip")


class Forgetful(Crews):
    """Keeps something between calls: every second plan is another."""

    turn = [0]  # noqa: RUF012

    def update(self, known: Known, plan: Plan | None) -> Plan:
        self.turn[0] += 1
        made = super().update(known, plan)
        return made if self.turn[0] % 2 else Plan(made.order, made.coalitions, why=("odd",))


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (object, "has a method 'update', and object has none"),
        (Counting, r"heeds news out of NEWS, and Counting heeds \['gossip'\]"),
        (Silent, "returns a Plan, and Silent returned None"),
        (Impossible, "robots can go by every plan.*has a task 99, which is none"),
        (Lazy, "a mission that can be done is completed"),
        (Forgetful, "the same knowledge gets the same plan"),
    ],
)
def test_what_is_wrong_with_a_coordinator_is_told(make: Any, told: str) -> None:
    with pytest.raises(AssertionError, match=told):
        check_coordinator(make, [two_robots_one_task()])


class Deaf:
    needs_everything = False


class Curious(JoinAll):
    def begin(self, everything: Any, rng: np.random.Generator) -> None:
        len(everything)


class Modest(JoinAll):
    needs_everything = True


class Greedy(JoinAll):
    def decide(self, view: Any) -> Decision:
        return Decision(view.counts + 5)


class Flat(JoinAll):
    def decide(self, view: Any) -> Decision:
        return Decision(view.counts[0])


class Scribbling(JoinAll):
    def decide(self, view: Any) -> Decision:
        view.counts[:] += 1
        return super().decide(view)


class Moody(JoinAll):
    """Draws from the clock, as it were."""

    mood = [0]  # noqa: RUF012

    def begin(self, everything: Any, rng: np.random.Generator) -> None:
        self.mood[0] += 1

    def decide(self, view: Any) -> Decision:
        task = np.full(len(view.counts), -1 if self.mood[0] % 2 else 0)
        return super().decide(view) if self.mood[0] % 2 else Decision(view.counts, task)


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (Deaf, "a policy has 'begin', and Deaf has not"),
        (Curious, "begins without missions, and Curious raised TypeError"),
        (Modest, "refuses to begin without missions, and Modest did not"),
        (Greedy, "Greedy decided otherwise . times in step"),
        (Flat, "a decision has a row for each team"),
        (Scribbling, "a view is only read, and Scribbling changed counts"),
        (Moody, "the same seed gives the same record, and Moody did otherwise"),
    ],
)
def test_what_is_wrong_with_a_policy_is_told(make: Any, told: str) -> None:
    with pytest.raises(AssertionError, match=told):
        check_policy(make, [two_robots_one_task()])


class Still:
    """Stands at (0, 0)."""

    def __init__(self, mission: Any, robot: int) -> None:
        self.count = 0

    def command(self, command: Command) -> None:
        pass

    def report(self) -> Any:
        self.count += 1
        return Report(0.0, 0.0, number=self.count)

    def close(self) -> None:
        pass


class Telling(Still):
    def report(self) -> Any:
        return "here"


class Lost(Still):
    def report(self) -> Any:
        return Report(float("nan"), 0.0)


class Backwards(Still):
    def report(self) -> Any:
        self.count -= 1
        return Report(0.0, 0.0, number=self.count)


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (lambda mission, robot: object(), "a body has a method 'command'"),
        (Still, r"takes up leg 1 and goes to \(3, 0\), and after 0.2 s"),
        (Telling, "returns a Report or None, and this returned str"),
        (Lost, "reports its place in numbers"),
        (Backwards, "'number' grows from report to report, and after -1 came -2"),
    ],
)
def test_what_is_wrong_with_a_body_is_told(make: Any, told: str) -> None:
    with pytest.raises(AssertionError, match=told):
        check_body(make, seconds=0.2)
