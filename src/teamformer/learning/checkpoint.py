"""Checkpoints: weights and optimisers in safetensors, all else in JSON; nothing is unpickled."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import torch
from safetensors.torch import load_file
from safetensors.torch import save as to_bytes
from torch import Tensor

from teamformer.base.errors import TeamformerError
from teamformer.base.whole_files import write_all
from teamformer.learning.algorithms.optimiser import Learner

FORMAT = 3
WEIGHTS, ABOUT = "weights.safetensors", "training.json"


@dataclass(frozen=True)
class TrainingProgress:
    """Where a training stands."""

    iteration: int = 0  # how many are done
    steps: int = 0  # of worlds
    seconds: float = 0.0  # spent
    best_failures: float = 1e9  # of the checkpoint selected so far
    best_cost: float = 1e9


def save(
    folder: Path, learner: Learner, settings: dict[str, Any], progress: TrainingProgress
) -> None:
    """Write a checkpoint; an older one in the folder stays whole until the new one is."""
    folder.mkdir(parents=True, exist_ok=True)
    about = {"format": FORMAT, "settings": settings, "progress": vars(progress)}
    weights, text = to_bytes(_tensors(learner)), json.dumps(about, indent=2)
    write_all({folder / WEIGHTS: weights, folder / ABOUT: text})


def read_about(folder: Path) -> dict[str, Any]:
    """Return the JSON part of a checkpoint.

    Raises `TeamformerError` if there is none, it is broken, or of a newer format.
    """
    try:
        about: dict[str, Any] = json.loads((folder / ABOUT).read_text())
        found = int(about["format"])
    except OSError:
        raise TeamformerError(f"{folder} holds no checkpoint", f"it has no {ABOUT}") from None
    except (ValueError, KeyError, TypeError):
        raise TeamformerError(f"{folder / ABOUT} is not readable") from None
    if found > FORMAT:
        hint = f"this version reads up to {FORMAT}; update teamformer"
        raise TeamformerError(f"{folder} has checkpoint format {found}", hint)
    return about


def load(folder: Path, learner: Learner, settings: dict[str, Any]) -> TrainingProgress:
    """Put a checkpoint into a learner made with the same settings."""
    about = read_about(folder)
    begun = settings | about["settings"]  # an older one lacks what is new
    changed = [name for name in settings if begun[name] != settings[name]]
    if changed:
        hint = f"other settings: {', '.join(changed)}; use the same or another folder"
        raise TeamformerError(f"{folder} holds another training", hint)
    tensors = _read_tensors(folder)
    _load_weights(learner, tensors)
    for name in ("policy_optimizer", "critic_optimizer"):
        _restore(getattr(learner, name), _under(tensors, name))
    return TrainingProgress(**about["progress"])


def load_weights(folder: Path, learner: Learner) -> None:
    """Begin with the weights of another training, with fresh optimisers."""
    read_about(folder)
    _load_weights(learner, _read_tensors(folder))


def load_policy_weights(folder: Path, learner: Learner) -> None:
    """Take the policy's weights alone, to run it."""
    _load_weights(learner, _read_tensors(folder), ("policy",))


def _read_tensors(folder: Path) -> dict[str, Tensor]:
    try:
        return load_file(folder / WEIGHTS)
    except Exception as error:  # safetensors raises its own, unrelated to OSError
        raise TeamformerError(f"{folder / WEIGHTS} is not readable: {error}") from None


def _load_weights(
    learner: Learner, tensors: dict[str, Tensor], names: Sequence[str] = ("policy", "critic")
) -> None:
    try:
        for name in names:
            getattr(learner, name).load_state_dict(_under(tensors, name))
    except RuntimeError as error:  # what torch raises for other names and shapes
        raise TeamformerError(f"the checkpoint is for another network: {error}") from None


def _tensors(learner: Learner) -> dict[str, Tensor]:
    tensors = {}
    for name in ("policy", "critic"):
        for key, value in getattr(learner, name).state_dict().items():
            tensors[f"{name}.{key}"] = value
        optimizer = getattr(learner, f"{name}_optimizer")
        for number, state in optimizer.state_dict()["state"].items():
            for key, value in state.items():
                tensors[f"{name}_optimizer.{number}.{key}"] = value
    return tensors


def _under(tensors: dict[str, Tensor], name: str) -> dict[str, Tensor]:
    return {k[len(name) + 1 :]: t for k, t in tensors.items() if k.startswith(name + ".")}


def _restore(optimizer: torch.optim.Adam, tensors: dict[str, Tensor]) -> None:
    state: dict[int, dict[str, Tensor]] = {}
    for name, value in tensors.items():
        number, key = name.split(".")
        state.setdefault(int(number), {})[key] = value
    groups = optimizer.state_dict()["param_groups"]
    optimizer.load_state_dict({"state": state, "param_groups": groups})
