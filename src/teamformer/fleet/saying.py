"""Lines for those who watch the terminal of one robot's agent."""

from __future__ import annotations

import sys


def say(robot: str, message: str) -> None:
    """Print a line of a robot, on stderr and at once."""
    print(f"{robot}: {message}", file=sys.stderr, flush=True)
