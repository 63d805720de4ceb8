"""The folder that bounds what tools may read and write."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from teamformer.base.errors import TeamformerError
from teamformer.base.file_access import reading_only_in, refuse_outside

DEEPEST = 4
"""Folders inside one another that are looked through for files."""

T = TypeVar("T")


@dataclass(frozen=True)
class WorkFolder:
    """A folder; nothing outside of it is read or written, whatever a name or a link says."""

    root: Path

    def path(self, name: str) -> Path:
        """Return the path of a file or folder; TeamformerError if it is not inside."""
        if not name or "\0" in name:
            raise TeamformerError(f"{name!r} is no name of a file", "name one, such as dock.yaml")
        path = self.root / name
        refuse_outside(path, self.root)
        return path

    def new_file(self, name: str, endings: tuple[str, ...], replaces: bool = False) -> Path:
        """Return the path of a file to write, with its folder made.

        Raises `TeamformerError` for another ending, and for a file that is there unless it
        `replaces` that.
        """
        path = self.path(name)
        if path.suffix.lower() not in endings:
            raise TeamformerError(f"{name}: the name ends otherwise", f"use {', '.join(endings)}")
        if path.exists() and not replaces:
            raise TeamformerError(f"{name}: there is such a file", "name another, or set replace")
        self.new_folder(str(Path(name).parent))
        return path

    def new_folder(self, name: str, *holds: str) -> Path:
        """Return a folder, made if there is none, in which files are to be written.

        Raises `TeamformerError` if one of those that it `holds` is a link that leads out.
        """
        path = self.path(name)
        for file in holds:
            self.path(f"{name}/{file}")
        try:
            path.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            what = f"{name}: cannot be made: {error.strerror}"
            raise TeamformerError(what, "name another folder") from None
        return path

    def name(self, path: Path) -> str:
        """Return a path inside as it is seen from the folder."""
        return path.relative_to(self.root).as_posix()

    def read(self, name: str, reader: Callable[[Path], T]) -> T:
        """Return what a reader makes of a file; what that file names must be inside, too."""
        path = self.path(name)
        with reading_only_in(self.root):
            return reader(path)

    def files(self, endings: tuple[str, ...]) -> Iterator[str]:
        """Yield the names of files with such endings; links and hidden folders are left out."""
        yield from self._files(self.root, endings, DEEPEST)

    def _files(self, folder: Path, endings: tuple[str, ...], depth: int) -> Iterator[str]:
        try:
            found = sorted(folder.iterdir())
        except OSError:  # nobody may look into it
            return
        for path in found:
            if path.name.startswith(".") or path.is_symlink():
                continue
            if path.is_dir() and depth > 0:
                yield from self._files(path, endings, depth - 1)
            elif path.suffix.lower() in endings:
                yield self.name(path)
