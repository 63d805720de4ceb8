"""Folders of trained policies that were changed, cut off or come from another version."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from teamformer.base.errors import TeamformerError
from teamformer.methods.learned.onnx_sessions import shipped
from teamformer.methods.learned.policy import Learned
from teamformer.methods.trained_folder import ABOUT, NETWORK, load_trained

GOOD = {"format": 1, "network": "gnn", "capabilities": 4}


def folder_saying(folder: Path, about: object) -> Path:
    """Return a folder with the shipped graph network and a text about it."""
    (folder / NETWORK).write_bytes(shipped("gnn-c4.onnx"))
    (folder / ABOUT).write_text(json.dumps(about))
    return folder


def test_a_sound_folder_is_a_policy(tmp_path: Path) -> None:
    assert isinstance(load_trained(folder_saying(tmp_path, GOOD)), Learned)


@pytest.mark.parametrize(
    ("about", "told"),
    [
        ({**GOOD, "format": 2, "brain": "large"}, "has policy format 2"),
        ({**GOOD, "format": "one"}, "is not readable"),
        ({**GOOD, "brain": "large"}, "is not readable"),
        ({**GOOD, "network": ["gnn"]}, "is not readable"),
        ({**GOOD, "network": "rnn"}, "there is no network 'rnn'"),
        ({**GOOD, "network": "any"}, "takes"),
        ({**GOOD, "capabilities": "four"}, "is not readable"),
        ({**GOOD, "capabilities": True}, "is not readable"),
        ({**GOOD, "capabilities": 0}, "is not readable"),
        ({**GOOD, "capabilities": None}, "does not say for how many"),
        ({**GOOD, "capabilities": 8}, "is not made for 8 capabilities"),
        ({}, "is not readable"),
        ([], "is not readable"),
    ],
)
def test_what_does_not_belong_together_is_refused(about: object, told: str, tmp_path: Path) -> None:
    with pytest.raises(TeamformerError, match=told):
        load_trained(folder_saying(tmp_path, about))


def test_a_truncated_network_is_refused(tmp_path: Path) -> None:
    network = folder_saying(tmp_path, GOOD) / NETWORK
    network.write_bytes(network.read_bytes()[:1000])
    with pytest.raises(TeamformerError, match="holds no network that runs"):
        load_trained(tmp_path)
