"""Files are there whole or not at all."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from teamformer.base.whole_files import write_all, write_whole


def test_text_is_written_as_utf_8_and_bytes_as_they_are(tmp_path: Path) -> None:
    one, other = tmp_path / "one", tmp_path / "other"
    write_all({one: "größe\n", other: b"\0\xff"})
    assert one.read_bytes() == b"gr\xc3\xb6\xc3\x9fe\n"
    assert other.read_bytes() == b"\0\xff"


def test_where_one_of_several_cannot_be_written_all_stay_as_they_were(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The disk is full after the first file."""
    one, other = tmp_path / "one", tmp_path / "other"
    one.write_text("old")
    write = Path.write_bytes

    def write_until_full(path: Path, data: bytes) -> int:
        if data == b"too much":
            write(path, data[:3])
            raise OSError(28, "No space left on device")
        return write(path, data)

    monkeypatch.setattr(Path, "write_bytes", write_until_full)
    with pytest.raises(OSError, match=rf"No space left on device: '{other}'"):
        write_all({one: "new", other: "too much"})
    assert one.read_text() == "old"
    assert list(tmp_path.iterdir()) == [one]


def test_a_link_stays_a_link(tmp_path: Path) -> None:
    real, link = tmp_path / "real", tmp_path / "link"
    link.symlink_to(real)
    write_whole(link, "content")
    assert link.is_symlink()
    assert real.read_text() == "content"


def test_what_is_no_plain_file_is_written_to_not_replaced(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    write_whole(pipe, "content")
    assert os.read(reader, 100) == b"content"
    os.close(reader)
    assert pipe.is_fifo()
