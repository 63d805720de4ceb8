"""Policies by name: the listed ones, and a user's own class."""

from __future__ import annotations

import difflib
import importlib.util
import inspect
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from teamformer.errors import TeamformerError
from teamformer.policies.listing import Listing
from teamformer.policies.own import telling_where, watch_own
from teamformer.policies.protocol import Guarded, Policy

BARE = "-bare"
"""After the name of a learned policy: without its deadlock guard."""


def load_policy(name: str, listings: Sequence[Listing]) -> Policy:
    """Return a policy by its listed name, as `module:Class`, or from the folder of a training.

    With `-bare` after it a learned policy goes without its deadlock guard. Raises `TeamformerError`
    for a name that is unknown and for a class that is no policy.
    """
    for listing in listings:
        if listing.name == name:
            return _instance(listing.where)
    if name and Path(name).is_dir():
        # brings all that networks need
        from teamformer.trials.trained_folder import load_trained

        return load_trained(Path(name))
    if name.endswith(BARE):
        return _bare(name, listings)
    if ":" in name:
        return _instance(name)
    known = [listing.name for listing in listings]
    near = difflib.get_close_matches(name, known, 1)
    hint = f"did you mean '{near[0]}'?" if near else f"known are {', '.join(known)};"
    hint += " your own is module:Class or a folder"
    raise TeamformerError(f"there is no policy '{name}'", hint)


def _bare(name: str, listings: Sequence[Listing]) -> Policy:
    try:
        policy = load_policy(name.removesuffix(BARE), listings)
    except TeamformerError as error:
        raise TeamformerError(f"there is no policy '{name}': {error}", error.hint) from None
    if not isinstance(policy, Guarded):
        hint = f"{BARE} is for learned policies, which have one"
        raise TeamformerError(f"there is no policy '{name}': it has no deadlock guard", hint)
    policy.is_guarded = False
    return policy


def files_of_own(name: str, listings: Sequence[Listing]) -> list[Path]:
    """Return the files that make a policy of a user's own: of its class, or of a trained folder.

    What the class imports is not among them. A listed policy has none.
    """
    folder = Path(name.removesuffix(BARE))
    if folder.name in {listing.name for listing in listings}:
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
        raise TeamformerError(f"policy '{where}' cannot be imported: it is no name", hint)
    _look_here()
    policy = _make(_find(where, module_name, class_name), where)
    for part in ("needs_everything", "begin", "decide"):
        if not hasattr(policy, part):
            hint = "see docs/policies.md for what a policy offers"
            raise TeamformerError(f"'{where}' is no policy: it has no '{part}'", hint)
    return policy if where.startswith("teamformer.") else watch_own(policy, where)


def _find(where: str, module_name: str, class_name: str) -> Any:
    try:
        with telling_where(f"policy '{where}' cannot be imported"):
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
