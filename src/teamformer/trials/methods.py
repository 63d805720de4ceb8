"""Methods by name: how a mission is solved; the listed ones, and a user's own class."""

from __future__ import annotations

import difflib
import importlib.util
import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from typing import Any, TypeGuard, cast

from teamformer.coordination import Coordinator
from teamformer.coordinators.crews import Crews
from teamformer.coordinators.own import OwnCoordinator
from teamformer.coordinators.shared_plan import SharedPlan
from teamformer.errors import TeamformerError
from teamformer.model import Scenario
from teamformer.own_code import load_own, look_here, telling_where
from teamformer.planning.steps.shared_plan import is_too_large
from teamformer.policies.learned.shipped import Card, shipped_cards, shipped_policy
from teamformer.policies.own import watch_own
from teamformer.policies.protocol import Guarded, Planner, Policy

BARE = "-bare"
"""After the name of a learned policy: without its deadlock guard."""

DEFAULT, STAND_IN = "plan", "crews"
"""What is chosen for a mission, and for one that is too large to share a plan soon."""


@dataclass(frozen=True)
class Method:
    """How a mission is solved: by a coordinator or by a policy.

    With a `coordinator` teams follow its plans, and there is no policy. With a `policy` teams head
    for tasks by the paper's shared order and allocator, and the policy decides when they join and
    split. A policy that plans, such as `central`, brings its own coordinator. Two settings are for
    measurements: `new_tasks` says how the paper's order treats tasks that appear, and `foresight`
    how unknown needs are treated.
    """

    name: str
    policy: Policy | None = None
    coordinator: Coordinator | None = None
    new_tasks: str = "resolve"
    foresight: str = "scouting"

    def __post_init__(self) -> None:
        if (self.policy is None) == (self.coordinator is None):
            raise ValueError(f"method '{self.name}' needs a policy or a coordinator, and not both")

    @property
    def needs_everything(self) -> bool:
        """Say whether it is told the truth of the mission, which no robot can know."""
        return self.policy is not None and self.policy.needs_everything


Player = Method | Policy | Coordinator


def as_method(player: Player) -> Method:
    """Return a method; a policy or a coordinator makes one by itself, named as its class.

    Raises `TeamformerError` for what is neither.
    """
    if isinstance(player, Method):
        return player
    if isinstance(player, type):
        what = f"'{player.__name__}' is a class, and a method is an object"
        raise TeamformerError(what, f"pass {player.__name__}()")
    own = _own_or_ours(player, type(player).__name__)
    if _is_coordinator(own):
        return Method(type(player).__name__, coordinator=own)
    return Method(type(player).__name__, policy=cast(Policy, own))


def _is_coordinator(player: Any) -> TypeGuard[Coordinator]:
    return hasattr(player, "update")


def with_settings(method: Method, settings: Mapping[str, str]) -> Method:
    """Return a method with its `new_tasks` or `foresight` changed, as suites of benchmarks do.

    A shared plan sends scouts only with the foresight `scouting`.
    """
    changed = replace(
        method,
        new_tasks=settings.get("new_tasks", method.new_tasks),
        foresight=settings.get("foresight", method.foresight),
    )
    if isinstance(changed.coordinator, SharedPlan):
        scouts = changed.foresight == "scouting"
        return replace(changed, coordinator=replace(changed.coordinator, scouts=scouts))
    return changed


@dataclass(frozen=True)
class Listing:
    """A method that can be named: how it is made, and what to say of it."""

    name: str
    make: Callable[[], Policy | Coordinator]
    summary: str
    tasks_by: str = "the paper's order"
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
        SharedPlan,
        "the shared plan: every robot works out alike who does what with whom, and who scouts",
        "the shared plan",
    ),
    Listing(
        "crews",
        Crews,
        "standing parts of the fleet, each with a list of tasks; for very large missions",
        "crews",
    ),
    Listing(
        "central",
        _imported("central.policy:Central"),
        "knows everything, searches for a plan for a time, proves bounds with OR-Tools CP-SAT",
        "its own plan",
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
    for a name that is unknown and for a class that is neither policy nor coordinator.
    """
    made = _make_player(name)
    if _is_coordinator(made):
        return Method(name, coordinator=made)
    if isinstance(made, Planner):
        made.time_limit = made.time_limit if time_limit is None else time_limit
        made.workers = made.workers if workers is None else workers
    return Method(name, policy=cast(Policy, made))


def default_for(mission: Scenario) -> str:
    """Return the name of the method that suits a mission: `crews` if it is too large for `plan`."""
    return STAND_IN if is_too_large(mission) else DEFAULT


def _make_player(name: str) -> Policy | Coordinator:
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
    if not name:
        hint = "write one, or drop a comma from a list of them"
        raise TeamformerError("there is no method without a name", hint)
    near = difflib.get_close_matches(name, LISTED, 1)
    hint = f"did you mean '{near[0]}'?" if near else f"known are {', '.join(LISTED)};"
    hint += " your own is module:Class or a folder"
    raise TeamformerError(f"there is no method '{name}'", hint)


def _bare(name: str) -> Guarded:
    try:
        policy = _make_player(name.removesuffix(BARE))
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
    look_here()
    spec = importlib.util.find_spec(module_name)
    return [Path(spec.origin)] if spec is not None and spec.origin is not None else []


def _instance(where: str) -> Policy | Coordinator:
    module_name, _, class_name = where.partition(":")
    if not all(part.isidentifier() for part in (*module_name.split("."), class_name)):
        hint = "write it as module:Class, such as mine:Patient for class Patient in mine.py"
        raise TeamformerError(f"method '{where}' cannot be imported: it is no name", hint)
    return _own_or_ours(_make(load_own(where, "method"), where), where)


def _own_or_ours(made: Any, name: str) -> Policy | Coordinator:
    """Return a policy or a coordinator; one that a user wrote is told by `name` if it fails."""
    is_ours = type(made).__module__.startswith("teamformer.")
    if _is_coordinator(made):
        return made if is_ours else OwnCoordinator(made, name)
    policy: Policy = made
    for part in ("needs_everything", "begin", "decide"):
        if not hasattr(policy, part):
            hint = "see docs/reference/methods.md for what a policy and a coordinator offer"
            what = f"'{name}' is neither a coordinator, as it has no 'update', nor a policy"
            raise TeamformerError(f"{what}: it has no '{part}'", hint)
    return policy if is_ours else watch_own(policy, name)


def _make(make: Any, where: str) -> Any:
    try:
        inspect.signature(make).bind()
    except TypeError as error:
        raise TeamformerError(f"'{where}' cannot be made without arguments: {error}") from None
    with telling_where(f"'{where}' cannot be made"):
        return make()
