"""Files in: whole files of a bounded size, with what stands in the way told clearly."""

from __future__ import annotations

import difflib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from importlib.resources import files
from pathlib import Path

from teamformer.base.errors import TeamformerError

LARGEST_SETTINGS = 1_000_000
"""Bytes of a file of settings."""

POINTER = b"version https://git-lfs.github.com/spec/"
"""What the pointers of Git LFS begin with, which stand for files that are not fetched yet."""


_bound: ContextVar[Path | None] = ContextVar("_bound", default=None)
"""The folder that nothing is read outside of, if there is one."""


@contextmanager
def reading_only_in(folder: Path) -> Iterator[None]:
    """Have files outside of a folder refused, also those that a file inside names or links to.

    It holds in this thread, and in those that it gives its work to.
    """
    token = _bound.set(folder.resolve())
    try:
        yield
    finally:
        _bound.reset(token)


def refuse_outside(path: Path, folder: Path) -> None:
    """Raise `TeamformerError` for a path that leads out of a folder, by itself or by links."""
    try:
        is_inside = path.resolve().is_relative_to(folder.resolve())
    except (OSError, RuntimeError, ValueError):  # links in a circle; a name with a zero byte
        is_inside = False
    if not is_inside:
        raise TeamformerError(f"{path}: this is not in {folder}", "name a file in that folder")


def read_bytes(path: Path, largest: int, hint: str = "") -> bytes:
    """Return what a file holds, up to `largest` bytes; `hint` helps where there is no such file."""
    if (folder := _bound.get()) is not None:
        refuse_outside(path, folder)
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
    if data.startswith(POINTER):
        what = f"{path}: this is a pointer of Git LFS and not the file itself"
        raise TeamformerError(what, "fetch the file by `git lfs pull`")
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


def names_of_shipped(*folder: str) -> list[str]:
    """Return the names of the YAML files that come with the package in one of its folders."""
    found = files("teamformer").joinpath(*folder).iterdir()
    return sorted(file.name.removesuffix(".yaml") for file in found)


def read_shipped_or_own(
    name: str, folder: Sequence[str], missing: str, own: str, others: Sequence[str] = ()
) -> tuple[str, str]:
    """Return the text of a YAML file, and what to call it in errors.

    `name` is that of a file which comes with the package in `folder`, or the path of the user's own
    that ends in .yaml. Raises `TeamformerError` for an unknown name: `missing` says what there is
    not, the hint the nearest names, `others` among them, and how to name one's `own`.
    """
    if name.endswith((".yaml", ".yml")):
        return read_text(Path(name), LARGEST_SETTINGS), name
    known = names_of_shipped(*folder)
    if name not in known:
        known += others
        near = " or ".join(f"'{one}'" for one in difflib.get_close_matches(name, known))
        hint = f"did you mean {near}?" if near else f"there are {', '.join(known)};"
        raise TeamformerError(f"{missing} '{name}'", f"{hint} {own}")
    file = files("teamformer").joinpath(*folder, f"{name}.yaml")
    return file.read_text(encoding="utf-8"), file.name
