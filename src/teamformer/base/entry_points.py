"""What packages bring by name, this one and others: methods, bodies, importers and exporters.

A package says so in its `pyproject.toml`, as entry points of `teamformer.methods` and the like.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from typing import Any

from teamformer.base.errors import TeamformerError
from teamformer.base.extras import how_to_install, missing
from teamformer.base.own_code import telling_where

OURS = "teamformer"
"""The package whose entry points are our own."""

GROUPS = {
    "method": "teamformer.methods",
    "body": "teamformer.bodies",
    "importer": "teamformer.importers",
    "exporter": "teamformer.exporters",
}
"""The groups of entry points, by what is brought."""


@dataclass(frozen=True)
class Brought:
    """Something that a package brings under a name; loaded when it is asked for."""

    what: str
    entry: EntryPoint
    package: str

    def __str__(self) -> str:
        return f"{self.what} '{self.name}' of package '{self.package}'"

    @property
    def name(self) -> str:
        """Return the name that users give."""
        return self.entry.name

    @property
    def is_ours(self) -> bool:
        """Say whether it comes with Teamformer."""
        return self.package == OURS

    def load(self) -> Any:
        """Return the class or function; raises `TeamformerError` where it cannot be imported."""
        try:
            with telling_where(f"{self} cannot be loaded"):
                return self.entry.load()
        except TeamformerError as error:
            cause = error.__cause__
            if isinstance(cause, ModuleNotFoundError) and self.is_ours and self.entry.extras:
                raise missing(self.entry.extras[0], str(cause.name)) from None
            raise TeamformerError(str(error), error.hint or self._remedy) from cause

    def call(self, *given: Any) -> Any:
        """Load and call it; what another package raises is told by file and line."""
        made = self.load()
        if self.is_ours:
            return made(*given)
        with telling_where(f"{self} failed"):
            return made(*given)

    @property
    def _remedy(self) -> str:
        if self.is_ours:
            return f"install Teamformer again: {how_to_install()}"
        return f"update the package, or remove it: pip uninstall {self.package}"


@cache
def brought(what: str) -> tuple[Brought, ...]:
    """Return all that packages bring of a kind, read once: ours first, then by name.

    Raises `TeamformerError` if this package brings none, as one that was installed before it did.
    """
    found = [
        Brought(what, entry, str(entry.dist.name) if entry.dist else "unknown")
        for entry in entry_points(group=GROUPS[what])
    ]
    if not any(one.is_ours for one in found):
        hint = f"install it again: {how_to_install()}"
        raise TeamformerError(f"this installation of Teamformer names no {what} of its own", hint)
    return tuple(sorted(found, key=lambda one: (not one.is_ours, one.name, one.package)))


def names_of(what: str) -> tuple[str, ...]:
    """Return the names that something of a kind has, once each."""
    return tuple(dict.fromkeys(one.name for one in brought(what)))


def find_brought(what: str, name: str, ours: Collection[str] = ()) -> Brought | None:
    """Return what is brought under a name; None where no package brings any.

    `ours` are names that Teamformer has besides. Raises `TeamformerError` where two packages bring
    one name.
    """
    found = [one for one in brought(what) if one.name == name]
    packages = [*([OURS] if name in ours else []), *(one.package for one in found)]
    if len(packages) > 1:
        listed = " and ".join(packages)
        hint = f"remove one of them: pip uninstall {packages[-1]}"
        raise TeamformerError(f"{what} '{name}' comes with two packages, {listed}", hint)
    return found[0] if found else None
