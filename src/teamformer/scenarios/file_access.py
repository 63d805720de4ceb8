"""Files in: whole files of a bounded size, with what stands in the way told clearly."""

from __future__ import annotations

from pathlib import Path

from teamformer.errors import TeamformerError


def read_bytes(path: Path, largest: int, hint: str = "") -> bytes:
    """Return what a file holds, up to `largest` bytes; `hint` helps where there is no such file."""
    try:
        if path.is_dir():
            raise TeamformerError(f"{path}: this is a folder", "name a file in it")
        if path.exists() and not path.is_file():  # a pipe or a device might never end
            raise TeamformerError(f"{path}: this is not a plain file")
        with path.open("rb") as file:
            data = file.read(largest + 1)
    except FileNotFoundError:
        raise TeamformerError(f"{path}: there is no such file", hint) from None
    except (OSError, ValueError) as error:  # ValueError: a name with a zero byte
        reason = getattr(error, "strerror", None) or error
        raise TeamformerError(f"{path}: cannot be read: {reason}") from None
    if len(data) > largest:
        raise TeamformerError(f"{path}: larger than {largest // 10**6} MB; is it the right file?")
    return data


def read_text(path: Path, largest: int, hint: str = "") -> str:
    """Return the text that a file holds."""
    try:
        return read_bytes(path, largest, hint).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise TeamformerError(
            f"{path}: this is not text: byte {error.start + 1} is no UTF-8",
            "name another file, or save this one as UTF-8",
        ) from None
