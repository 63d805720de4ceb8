"""Methods by name: how a mission is solved; the listed ones, and a user's own class."""

from __future__ import annotations

import difflib
import importlib.util
import inspect
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from typing import Any

from teamformer.errors import TeamformerError
from teamformer.model import Scenario
from teamformer.planning.teams.shared_plan import is_too_large
from teamformer.policies.learned.shipped import Card, shipped_cards, shipped_policy
from teamformer.policies.own import telling_where, watch_own
from teamformer.policies.protocol import Guarded, Planner, Policy

BARE = "-bare"
"""After the name of a learned policy: without its deadlock guard."""

DEFAULT, STAND_IN = "plan", "crews"
"""What is chosen for a mission, and for one that is too large to share a plan soon."""


@dataclass(frozen=True)
class Method:
    """How a mission is solved: what tells robots their tasks, and the policy that forms teams.

    `allocation` is `paper` (the paper's shared order and its allocator), `crews` or `plan`. Two
    settings are for measurements: `new_tasks`, what the paper's order does with tasks that appear,
    and `foresight`, what a plan assumes about needs that nobody knows yet. None leaves the
    mission's own, which only settings of benchmarks such as `4N20+20T-C4-nn` set.
    """

    name: str
    policy: Policy
    allocation: str = "paper"
    new_tasks: str | None = None
    foresight: str | None = None

    def apply(self, mission: Scenario) -> Scenario:
        """Return a mission as this method plays it."""
        return replace(
            mission,
            allocation=self.allocation,
            new_tasks=self.new_tasks or mission.new_tasks,
            foresight=self.foresight or mission.foresight,
        )


def as_method(method: Method | Policy, mission: Scenario) -> Method:
    """Return a method; of a policy by itself, one that plays a mission as it stands."""
    if isinstance(method, Method):
        return method
    return Method(type(method).__name__, method, mission.allocation)


SETTINGS = ("new_tasks", "foresight")
"""What a suite may set of a method."""


def with_settings(method: Method, settings: Mapping[str, str]) -> Method:
    """Return a method with some of `SETTINGS` changed, as suites of benchmarks do."""
    return replace(method, **settings)  # type: ignore[arg-type]


@dataclass(frozen=True)
class Listing:
    """A method that can be named: how its policy is made, and what to say of it."""

    name: str
    make: Callable[[], Policy]
    summary: str
    allocation: str = "paper"
    trained_on: str = "nothing to train"


def _imported(where: str) -> Callable[[], Policy]:
    """Return what makes a policy of the class at `module:Class`, imported when it is needed."""

    def make() -> Policy:
        module, _, name = where.partition(":")
        policy: Policy = getattr(import_module(f"teamformer.policies.{module}"), name)()
        return policy

    return make


def _listing_of(card: Card) -> Listing:
    return Listing(
        card.name,
        lambda: shipped_policy(card.name),
        card.summary,
        trained_on=card.trained_on,
    )


METHODS = (
    Listing(
        "plan",
        _imported("scripted.follow_plan:FollowPlan"),
        "the shared plan: every robot works out alike who does what with whom, and who scouts",
        "plan",
    ),
    Listing(
        "crews",
        _imported("scripted.joining:JoinCrew"),
        "standing parts of the fleet, each with a list of tasks; for very large missions",
        "crews",
    ),
    Listing(
        "central",
        _imported("central.policy:Central"),
        "knows everything, searches for a plan for a time, proves bounds with OR-Tools CP-SAT",
        "plan",
    ),
    Listing("heuristic", _imported("scripted.heuristic:Heuristic"), "the paper's heuristic"),
    Listing(
        "join-all",
        _imported("scripted.joining:JoinAll"),
        "joins whom it helps to join, never splits",
    ),
    Listing(
        "join-fitting",
        _imported("scripted.join_fitting:JoinFitting"),
        "as join-all, but joins nobody whom no task needs",
    ),
    *map(_listing_of, shipped_cards()),
)
LISTED = {listing.name: listing for listing in METHODS}


def load_method(name: str, time_limit: float | None = None, workers: int | None = None) -> Method:
    """Return a method by its listed name, as `module:Class`, or from the folder of a training.

    With `-bare` after it a learned policy goes without its deadlock guard. `time_limit` (seconds)
    and `workers` (threads) are what a planner may take for each mission. Raises `TeamformerError`
    for a name that is unknown and for a class that is no policy.
    """
    listing = LISTED.get(name)
    allocation = "paper" if listing is None else listing.allocation
    policy = _load_policy(name)
    if isinstance(policy, Planner):
        policy.time_limit = policy.time_limit if time_limit is None else time_limit
        policy.workers = policy.workers if workers is None else workers
    return Method(name, policy, allocation)


def default_for(mission: Scenario) -> str:
    """Return the name of the method that suits a mission: `crews` if it is too large for `plan`."""
    return STAND_IN if is_too_large(mission) else DEFAULT


def _load_policy(name: str) -> Policy:
    if name in LISTED:
        return LISTED[name].make()
    if name and Path(name).is_dir():
        # brings all that networks need
        from teamformer.trials.trained_folder import load_trained

        return load_trained(Path(name))
    if name.endswith(BARE):
        return _bare(name)
    if ":" in name:
        return _instance(name)
    near = difflib.get_close_matches(name, LISTED, 1)
    hint = f"did you mean '{near[0]}'?" if near else f"known are {', '.join(LISTED)};"
    hint += " your own is module:Class or a folder"
    raise TeamformerError(f"there is no method '{name}'", hint)


def _bare(name: str) -> Policy:
    try:
        policy = _load_policy(name.removesuffix(BARE))
    except TeamformerError as error:
        raise TeamformerError(f"there is no method '{name}': {error}", error.hint) from None
    if not isinstance(policy, Guarded):
        hint = f"{BARE} is for learned policies, which have one"
        raise TeamformerError(f"there is no method '{name}': it has no deadlock guard", hint)
    policy.is_guarded = False
    return policy


def files_of_own(name: str) -> list[Path]:
    """Return the files that make a method of a user's own: of its class, or of a trained folder.

    What the class imports is not among them. A listed method has none.
    """
    folder = Path(name.removesuffix(BARE))
    if folder.name in LISTED:
        return []
    if name and folder.is_dir():
        kept = (".json", ".onnx")
        return sorted(path for path in folder.rglob("*") if path.suffix in kept)
    module_name, is_own, _ = name.removesuffix(BARE).partition(":")
    if not is_own or module_name.startswith("teamformer."):
        return []
    _look_here()
    spec = importlib.util.find_spec(module_name)
    return [Path(spec.origin)] if spec is not None and spec.origin is not None else []


def _look_here() -> None:
    """Have modules found in the folder that the user works in."""
    if str(Path.cwd()) not in sys.path:
        sys.path.append(str(Path.cwd()))


def _instance(where: str) -> Policy:
    module_name, _, class_name = where.partition(":")
    if not all(part.isidentifier() for part in (*module_name.split("."), class_name)):
        hint = "write it as module:Class, such as mine:Patient for class Patient in mine.py"
        raise TeamformerError(f"method '{where}' cannot be imported: it is no name", hint)
    _look_here()
    policy = _make(_find(where, module_name, class_name), where)
    for part in ("needs_everything", "begin", "decide"):
        if not hasattr(policy, part):
            hint = "see docs/policies.md for what a policy offers"
            raise TeamformerError(f"'{where}' is no policy: it has no '{part}'", hint)
    return policy if where.startswith("teamformer.") else watch_own(policy, where)


def _find(where: str, module_name: str, class_name: str) -> Any:
    try:
        with telling_where(f"method '{where}' cannot be imported"):
            module = importlib.import_module(module_name)
    except TeamformerError as error:
        if isinstance(error.__cause__, ImportError):
            error.hint = "run from the folder that holds the module"
        raise
    if not hasattr(module, class_name):
        raise TeamformerError(f"module '{module_name}' has no class '{class_name}'")
    return getattr(module, class_name)


def _make(make: Any, where: str) -> Policy:
    try:
        inspect.signature(make).bind()
    except TypeError as error:
        raise TeamformerError(f"'{where}' cannot be made without arguments: {error}") from None
    with telling_where(f"'{where}' cannot be made"):
        policy: Policy = make()
    return policy
