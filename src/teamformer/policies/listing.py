"""What is said of a policy that can be named."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Listing:
    """A policy that can be named: where its class is, and what to say of it."""

    name: str
    where: str  # module:Class
    summary: str
    trained_on: str = "nothing to train"
