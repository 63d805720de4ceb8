"""The command line, run in this process."""

from __future__ import annotations

import sys
from pathlib import Path
from unittest.mock import patch

from teamformer import cli

FOUR = str(Path(__file__).parent.parent / "examples" / "four-robots.yaml")


def teamformer(*words: str) -> int:
    """Run the command line in this process and return its exit status."""
    with patch.object(sys, "argv", ["teamformer", *words]):
        try:
            cli.main()
        except SystemExit as stop:
            return stop.code if isinstance(stop.code, int) else 0
    return 0
