"""Methods by name, what each is made of, and what is said of names that name none."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from small_worlds import make, robot, task
from teamformer.base.errors import TeamformerError
from teamformer.files.drawn.smallest import smallest_mission
from teamformer.methods.by_name import Method, as_method, default_for, load_method, with_settings
from teamformer.methods.central.policy import Central
from teamformer.methods.coordinators.crews import Crews
from teamformer.methods.coordinators.giving_out import GivesOutTasks, TeamformerTasks
from teamformer.methods.coordinators.reactive import Reactive
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.methods.coordinators.soonest import Soonest
from teamformer.methods.learned.policy import Learned
from teamformer.methods.listings import method_listings, method_names
from teamformer.methods.scripted.heuristic import Heuristic
from teamformer.methods.scripted.join_fitting import JoinFitting
from teamformer.methods.scripted.joining import JoinAll
from teamformer.methods.seam.protocol import Planner
from teamformer.world.env import TeamFormation

OWN = """
from teamformer.world.env import Decision

class Patient:
    needs_everything = False

    def begin(self, everything, rng):
        pass

    def decide(self, view):
        return None


class Deaf:
    needs_everything = False

    def begin(self, everything, rng):
        pass


class Picky(Patient):
    def __init__(self, taste):
        pass


class Rude(Patient):
    def begin(self, everything, rng):
        {}["seed"]

    def decide(self, view):
        return 1 / 0


class Slotted:
    __slots__ = ("needs_everything", "steps")

    def __init__(self):
        self.needs_everything, self.steps = False, 0

    def begin(self, everything, rng):
        self.steps = 1

    def decide(self, view):
        return self.steps / 0


class Vague(Patient):
    def decide(self, view):
        return Decision(view.counts + 0.5)


class Narrow(Patient):
    def decide(self, view):
        return Decision(view.counts[:, :1])


class Timed(Patient):
    time_limit, plans = 1.0, []

    def within(self, time_limit, workers):
        other = Timed()
        other.time_limit = time_limit
        return other

    def plan(self, everything, believed, rng):
        self.plans = [everything, believed]
"""


@pytest.fixture
def own_module(own_folder: Path) -> str:
    """A module of a user's, in the folder they work in."""
    (own_folder / "my_own_policies.py").write_text(OWN)
    (own_folder / "broken_policies.py").write_text("import no_such_library\n")
    (own_folder / "broken_policies_too.py").write_text("\nprint(nothing)\n")
    (own_folder / "unfinished_policies.py").write_text("class Class(\n")
    return "my_own_policies"


def test_listed_names() -> None:
    assert isinstance(load_method("heuristic").policy, Heuristic)
    assert isinstance(load_method("join-all").policy, JoinAll)


def test_learned_policies_go_without_their_deadlock_guard(own_module: str, tmp_path: Path) -> None:
    for name in ("teamformer", "gnn-c8"):
        with_it, bare = load_method(name).policy, load_method(f"{name}-bare").policy
        assert isinstance(with_it, Learned)
        assert isinstance(bare, Learned)
        assert (with_it.is_guarded, bare.is_guarded) == (True, False)
    for name in ("join-all-bare", f"{own_module}:Patient-bare"):
        with pytest.raises(TeamformerError, match="has no deadlock guard"):
            load_method(name)
    with pytest.raises(TeamformerError, match="no method 'gnn-bare'"):
        load_method("gnn-bare")


def test_networks_that_give_out_tasks_follow_the_best_of_some_samples() -> None:
    for name, samples in (("teamformer-tasks", 1), ("teamformer-tasks-of8", 8)):
        coordinator = load_method(name).coordinator
        assert isinstance(coordinator, GivesOutTasks)
        assert coordinator.samples == samples
    with pytest.raises(TeamformerError, match="no method 'plan-of8': it draws no samples"):
        load_method("plan-of8")
    with pytest.raises(TeamformerError, match="no method 'teamformer-tasks-of1'"):
        load_method("teamformer-tasks-of1")


def test_names_are_listed_once() -> None:
    listings = method_listings()
    names = [listing.name for listing in listings]
    assert tuple(names) == method_names()
    assert len(set(names)) == len(names)
    assert names[:3] == ["plan", "central", "crews"]  # the default comes first
    for listing in listings:
        assert listing.summary
        assert listing.trained_on
        assert listing.tasks_by


def test_each_name_brings_its_coordinator_or_its_policy() -> None:
    made_of = {}
    for name in method_names()[:9]:
        method = load_method(name)
        assert method.name == name
        made_of[name] = type(method.coordinator or method.policy)
    assert made_of == {
        "plan": SharedPlan,
        "crews": Crews,
        "central": Central,
        "heuristic": Heuristic,
        "join-all": JoinAll,
        "join-fitting": JoinFitting,
        "reactive": Reactive,
        "soonest": Soonest,
        "teamformer-tasks": TeamformerTasks,
    }
    assert {type(load_method(name).policy) for name in method_names()[9:]} == {Learned}


def test_suites_change_settings_of_methods() -> None:
    """Who foresees nothing sends no scouts."""
    changed = with_settings(load_method("plan"), {"foresight": "needed", "new_tasks": "nearest"})
    assert (changed.foresight, changed.new_tasks) == ("needed", "nearest")
    assert changed.coordinator == SharedPlan(scouts=False)
    assert with_settings(load_method("crews"), {}) == load_method("crews")


@pytest.mark.parametrize(
    "parts", [{}, {"policy": JoinAll(), "coordinator": Crews()}], ids=["neither", "both"]
)
def test_a_method_has_a_policy_or_a_coordinator(parts: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match="needs a policy or a coordinator, and not both"):
        Method("odd", **parts)


def test_only_planners_take_a_time_limit_and_threads() -> None:
    central: Any = load_method("central", time_limit=0.5, workers=2).policy
    assert (central.time_limit, central.workers) == (0.5, 2)
    central = load_method("central").policy
    assert (central.time_limit, central.workers) == (Central().time_limit, Central().workers)
    assert load_method("plan", time_limit=0.5) == load_method("plan")


@pytest.mark.parametrize(
    ("robots", "tasks", "name"),
    [(1, 1, "plan"), (3000, 2000, "plan"), (3001, 2000, "crews"), (1, 4000, "crews")],
)
def test_a_mission_too_large_for_a_plan_is_solved_by_crews(
    robots: int, tasks: int, name: str
) -> None:
    mission = make([robot("a", 0)] * robots, [task("a", 1)] * tasks)
    assert default_for(mission) == name


def test_a_class_of_ones_own(own_module: str) -> None:
    policy = load_method(f"{own_module}:Timed", time_limit=2.5).policy
    assert isinstance(policy, Planner)
    assert policy.time_limit == 2.5
    truth, belief = [smallest_mission()], [smallest_mission()]
    policy.plan(truth, belief, np.random.default_rng(0))
    assert [policy.plans[0] is truth, policy.plans[1] is belief] == [True, True]
    assert not isinstance(load_method(f"{own_module}:Patient").policy, Planner)


def test_an_object_of_ones_own_stays_as_it_is() -> None:
    """It is watched from outside: neither its class nor its attributes change."""

    class Mine(JoinAll):
        pass

    mine = Mine()
    policy = as_method(mine).policy
    assert policy is not mine
    assert (type(mine), vars(mine)) == (Mine, {})


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("Rude", r"failed at \S*my_own_policies.py:31: ZeroDivisionError: division by zero"),
        ("Slotted", r"failed at \S*my_own_policies.py:44: ZeroDivisionError: division by zero"),
        ("Patient", r"decide\(\) returned NoneType, not a Decision"),
        ("Vague", r"wanted holds what is no whole number of 32 bits"),
        ("Narrow", r"asks for wanted \(3, 2\) and task \(3,\); the decision has \(3, 1\)"),
    ],
)
def test_what_goes_wrong_in_a_policy_of_ones_own_is_told_by_line(
    name: str, message: str, own_module: str
) -> None:
    policy = load_method(f"{own_module}:{name}").policy
    view = TeamFormation([smallest_mission()]).view()
    with pytest.raises(TeamformerError, match=message):
        policy.decide(view)


def test_what_goes_wrong_when_a_policy_begins_is_told_by_line(own_module: str) -> None:
    policy = load_method(f"{own_module}:Rude").policy
    with pytest.raises(TeamformerError, match=r"my_own_policies.py:28: KeyError: 'seed'"):
        policy.begin(None, np.random.default_rng(0))


@pytest.mark.parametrize(
    ("name", "message", "hint"),
    [
        ("heuristik", "there is no method 'heuristik'", "did you mean 'heuristic'?"),
        ("quantum", "there is no method 'quantum'", "known are plan, central, crews, heuristic"),
        ("no_such_module:Class", "cannot be imported", "the folder that holds the module"),
        ("broken_policies:Class", "no_such_library", "the folder that holds the module"),
        (":Class", "cannot be imported", "write it as module:Class"),
        (".mine:X", "cannot be imported", "write it as module:Class"),
        ("my_own_policies:Nobody", "module 'my_own_policies' has no class 'Nobody'", ""),
        ("my_own_policies:Picky", "cannot be made without arguments", ""),
        ("broken_policies_too:Class", "broken_policies_too.py:2: NameError", ""),
        ("unfinished_policies:Class", "unfinished_policies.py:1: SyntaxError", ""),
        ("my_own_policies:Deaf", "nor a policy: it has no 'decide'", "docs/reference/methods.md"),
    ],
)
@pytest.mark.usefixtures("own_module")
def test_what_is_no_policy(name: str, message: str, hint: str) -> None:
    with pytest.raises(TeamformerError) as error:
        load_method(name)
    assert message in str(error.value)
    assert hint in error.value.hint
