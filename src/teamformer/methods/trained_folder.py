"""Policies in folders: what `teamformer train` leaves behind, run without torch."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

from teamformer.base.errors import TeamformerError
from teamformer.base.whole_files import write_whole
from teamformer.methods.coordinators.giving_out import GivesOutTasks
from teamformer.methods.learned.any_fleet import any_fleet
from teamformer.methods.learned.autoregressive import spelled_in
from teamformer.methods.learned.combinations import combining
from teamformer.methods.learned.dispatch.onnx_scorer import OnnxScorer
from teamformer.methods.learned.onnx_sessions import read_network
from teamformer.methods.seam.protocol import Policy
from teamformer.mission.coordination import Coordinator

ABOUT, NETWORK = "policy.json", "network.onnx"
FORMAT = 1


@dataclass(frozen=True)
class PolicyDescription:
    """What a folder says of its policy."""

    network: str  # the kind: any, teamformer, deepset, gnn
    capabilities: int | None  # the most that a mission may have; None: any number
    format: int = FORMAT


def load_trained(folder: Path) -> Policy | Coordinator:
    """Return the policy in a folder, or in one of its `best` and `last`; or the coordinator.

    Raises `TeamformerError` if there is none, it is broken, or of a newer format.
    """
    found = next((f for f in (folder, folder / "best", folder / "last") if _has_policy(f)), None)
    if found is None:
        hint = f"a trained policy has {ABOUT} and {NETWORK}; make one with teamformer train"
        raise TeamformerError(f"{folder} holds no policy", hint)
    about = _read(found / ABOUT)
    make = RUNTIMES.get(about.network)
    if make is None:
        raise TeamformerError(f"{found / ABOUT}: there is no network '{about.network}'")
    return make(found, about)


def describe_policy(about: PolicyDescription, folder: Path) -> None:
    """Write what the folder's policy is."""
    write_whole(folder / ABOUT, json.dumps(asdict(about), indent=2) + "\n")


def _has_policy(folder: Path) -> bool:
    return (folder / ABOUT).is_file()


def _read(file: Path) -> PolicyDescription:
    try:
        tree = json.loads(file.read_text())
        found = int(tree["format"])
        about = PolicyDescription(**tree) if found <= FORMAT else None  # a newer one may say more
    except (OSError, ValueError, TypeError, KeyError):
        about, found = None, 0
    if found > FORMAT:
        hint = f"this version reads up to {FORMAT}; update teamformer"
        raise TeamformerError(f"{file} has policy format {found}", hint)
    if about is None or not _is_sound(about):
        raise TeamformerError(f"{file} is not readable", "export the policy again")
    return about


def _is_sound(about: PolicyDescription) -> bool:
    """Say whether a file holds what it should, and no other kinds of values."""
    capabilities = about.capabilities
    if not isinstance(about.network, str) or isinstance(capabilities, bool):
        return False
    return capabilities is None or (isinstance(capabilities, int) and capabilities > 0)


def _any(folder: Path, about: PolicyDescription) -> Policy:
    return any_fleet(read_network(folder / NETWORK), str(folder / NETWORK))


def _spelled(folder: Path, about: PolicyDescription) -> Policy:
    return spelled_in(folder)


def _combined(folder: Path, about: PolicyDescription) -> Policy:
    if about.capabilities is None:
        raise TeamformerError(f"{folder / ABOUT} does not say for how many capabilities")
    content = read_network(folder / NETWORK)
    return combining(content, str(folder / NETWORK), about.capabilities)


def _giving_out(folder: Path, about: PolicyDescription) -> Coordinator:
    return GivesOutTasks(OnnxScorer(read_network(folder / NETWORK), str(folder / NETWORK)))


RUNTIMES: dict[str, Callable[[Path, PolicyDescription], Policy | Coordinator]] = {
    "tasks": _giving_out,
    "any": _any,
    "teamformer": _spelled,
    "teamformer-full": _spelled,
    "teamformer-paper": _spelled,
    "deepset": _combined,
    "gnn": _combined,
}
