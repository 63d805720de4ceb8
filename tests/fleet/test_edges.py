"""The edges of a process: its facts file, and how much others may say."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from teamformer.base.errors import TeamformerError
from teamformer.fleet.agent.knowledge import Remembered
from teamformer.fleet.messages import LoadFact, TaskFact
from teamformer.fleet.process.facts_file import FactsFile
from teamformer.fleet.transports.transport import MOST_A_SECOND, MOST_BYTES_A_SECOND, Sluice

KEPT = Remembered(
    3, (0, 2), (TaskFact(1 << 24, "new", 1.0, 2.0, (1,)),), 12.0, loads=(LoadFact(1, 2, 3.0, 4.0),)
)


def test_facts_are_read_as_they_were_written(tmp_path: Path) -> None:
    file = FactsFile(tmp_path / "facts", 42, 1)
    assert file.read() is None
    file.write(KEPT)
    read = file.read()
    assert read is not None
    assert (read.life, read.done, read.added) == (3, (0, 2), KEPT.added)
    assert read.loads == KEPT.loads
    assert read.age >= 12.0
    assert os.listdir(tmp_path) == ["facts"]


def test_a_half_written_file_leaves_the_old_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = FactsFile(tmp_path / "facts", 42, 1)
    file.write(KEPT)
    monkeypatch.setattr(os, "replace", lambda *_: (_ for _ in ()).throw(OSError("power cut")))
    with pytest.raises(OSError, match="power cut"):
        file.write(Remembered(9))
    read = file.read()
    assert read is not None
    assert read.life == 3


@pytest.mark.parametrize("content", [b"", b"nonsense", b"\xc1"])
def test_what_is_no_facts_file_is_refused(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "facts").write_bytes(content)
    with pytest.raises(TeamformerError, match="this is no facts file"):
        FactsFile(tmp_path / "facts", 42, 1).read()


def test_a_folder_is_no_facts_file(tmp_path: Path) -> None:
    with pytest.raises(TeamformerError, match="cannot be read: Is a directory") as refused:
        FactsFile(tmp_path, 42, 1).read()
    assert "name a file" in refused.value.hint


def test_facts_of_another_robot_are_refused(tmp_path: Path) -> None:
    FactsFile(tmp_path / "facts", 42, 1).write(KEPT)
    with pytest.raises(TeamformerError, match="another mission or robot"):
        FactsFile(tmp_path / "facts", 42, 2).read()


def test_a_sender_may_say_so_much_a_second() -> None:
    sluice = Sluice()
    assert all(sluice.lets(1, 10, 0.0) for _ in range(MOST_A_SECOND))
    assert not sluice.lets(1, 10, 0.9)
    assert sluice.lets(2, 10, 0.9)
    assert sluice.lets(1, 10, 1.1)
    assert sluice.lets(3, MOST_BYTES_A_SECOND, 5.0)
    assert not sluice.lets(3, 1, 5.5)
    assert sluice.dropped == 2
