"""Methods by name: how a mission is solved; those of packages, and a user's own class."""

from __future__ import annotations

import difflib
import importlib.util
import inspect
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeGuard, cast

from teamformer.base.errors import TeamformerError
from teamformer.base.own_code import load_own, look_here, telling_where
from teamformer.methods.coordinators.giving_out import GivesOutTasks
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.methods.learned.shipped import shipped_policy
from teamformer.methods.listings import CARDS, DEFAULT, STAND_IN, find_method, method_names
from teamformer.methods.seam.own_coordinator import OwnCoordinator
from teamformer.methods.seam.own_policy import watch_own
from teamformer.methods.seam.protocol import Guarded, Planner, Policy
from teamformer.mission.coordination import Coordinator
from teamformer.mission.model import Mission
from teamformer.planning.steps.shared_plan import is_too_large

BARE = "-bare"
"""After the name of a learned policy: without its deadlock guard."""

SAMPLES = re.compile(r"(.+)-of([2-9]|[1-9]\d+)")
"""The name of a method that gives out tasks, and how many samples it follows the best of."""


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


def load_method(name: str, time_limit: float | None = None, workers: int | None = None) -> Method:
    """Return a method by its listed name, as `module:Class`, or from the folder of a training.

    With `-bare` after it a learned policy goes without its deadlock guard, and with `-of8` a
    network that gives out tasks follows the best of eight samples. `time_limit` (seconds) and
    `workers` (threads) are what a planner may take for each mission. Raises `TeamformerError`
    for a name that is unknown and for a class that is neither policy nor coordinator.
    """
    made = _own_or_ours(_make_player(name), name)
    if _is_coordinator(made):
        return Method(name, coordinator=made)
    policy = cast(Policy, made)
    return Method(name, policy=_within(policy, time_limit, workers))


def _within(policy: Policy, time_limit: float | None, workers: int | None) -> Policy:
    return policy.within(time_limit, workers) if isinstance(policy, Planner) else policy


def default_for(mission: Mission) -> str:
    """Return the name of the method that suits a mission: `crews` if it is too large for `plan`.

    Crews plan in steps; in continuous time it is always `plan`.
    """
    return STAND_IN if mission.time == "steps" and is_too_large(mission) else DEFAULT


def _make_player(name: str) -> Any:
    """Return what goes by a name, as it is: nobody has asked yet what it can do."""
    if (found := find_method(name)) is not None:
        return _make(found.load(), str(found))
    if name in CARDS:
        return shipped_policy(name)
    if name and Path(name).is_dir():
        # brings all that networks need
        from teamformer.methods.trained_folder import load_trained

        return load_trained(Path(name))
    if name.endswith(BARE):
        return _bare(name)
    if (sampled := SAMPLES.fullmatch(name)) is not None:
        return _best_of(name, sampled[1], int(sampled[2]))
    if ":" in name:
        return _instance(name)
    if not name:
        hint = "write one, or drop a comma from a list of them"
        raise TeamformerError("there is no method without a name", hint)
    known = method_names()
    near = difflib.get_close_matches(name, known, 1)
    hint = f"did you mean '{near[0]}'?" if near else f"known are {', '.join(known)};"
    hint += " your own is module:Class or a folder"
    raise TeamformerError(f"there is no method '{name}'", hint)


def _bare(name: str) -> Policy:
    try:
        policy = _make_player(name.removesuffix(BARE))
    except TeamformerError as error:
        raise TeamformerError(f"there is no method '{name}': {error}", error.hint) from None
    if not isinstance(policy, Guarded):
        hint = f"{BARE} is for learned policies, which have one"
        raise TeamformerError(f"there is no method '{name}': it has no deadlock guard", hint)
    return policy.unguarded()


def _best_of(name: str, of: str, samples: int) -> Coordinator:
    try:
        made = _make_player(of)
    except TeamformerError as error:
        raise TeamformerError(f"there is no method '{name}': {error}", error.hint) from None
    if not isinstance(made, GivesOutTasks):
        hint = f"-of{samples} is for networks that give out tasks, such as teamformer-tasks"
        raise TeamformerError(f"there is no method '{name}': it draws no samples", hint)
    return made.of_samples(samples)


def without_suffix(name: str) -> str:
    """Return the name of a method without its `-bare` or `-of8`."""
    sampled = SAMPLES.fullmatch(name)
    return name.removesuffix(BARE) if sampled is None else sampled[1]


def files_of_own(name: str) -> list[Path]:
    """Return the files that make a method that is not ours: of its class, or of a trained folder.

    What the class imports is not among them. A method that comes with Teamformer has none.
    """
    name = without_suffix(name)
    folder, found = Path(name), find_method(name)
    if name in CARDS or (found is not None and found.is_ours):
        return []
    if found is None and name and folder.is_dir():
        kept = (".json", ".onnx")
        return sorted(path for path in folder.rglob("*") if path.suffix in kept)
    module_name, is_own, _ = (name if found is None else found.entry.value).partition(":")
    if not is_own or module_name.startswith("teamformer."):
        return []
    look_here()
    spec = importlib.util.find_spec(module_name)
    return [Path(spec.origin)] if spec is not None and spec.origin is not None else []


def _instance(where: str) -> Any:
    module_name, _, class_name = where.partition(":")
    if not all(part.isidentifier() for part in (*module_name.split("."), class_name)):
        hint = "write it as module:Class, such as mine:Patient for class Patient in mine.py"
        raise TeamformerError(f"method '{where}' cannot be imported: it is no name", hint)
    return _make(load_own(where, "method"), f"'{where}'")


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
        raise TeamformerError(f"{where} cannot be made without arguments: {error}") from None
    with telling_where(f"{where} cannot be made"):
        return make()
