"""How many examples are tried: the same few every day, other ones for `make fuzz`."""

from __future__ import annotations

from pathlib import Path

import hypothesis.internal.conjecture.providers as providers
import pytest
from hypothesis import HealthCheck, settings
from hypothesis.database import DirectoryBasedExampleDatabase

import watching

DATABASE = Path(__file__).parents[2] / "out" / "fuzz" / "examples"

SLOW = [HealthCheck.too_slow, HealthCheck.data_too_large, HealthCheck.large_base_example]
settings.register_profile(
    "everyday", derandomize=True, database=None, deadline=None, suppress_health_check=SLOW
)
settings.register_profile(
    "fuzz",
    database=DirectoryBasedExampleDatabase(DATABASE),
    deadline=None,
    suppress_health_check=SLOW,
    print_blob=True,
)
settings.load_profile("everyday")

# Hypothesis tries numbers and words out of our modules, too: out of those that happen to be
# imported by then. So the everyday examples would depend on which tests ran before.
assert hasattr(providers, "_get_local_constants")
providers._get_local_constants = lambda nothing=providers.Constants(): nothing


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say how many examples were tried."""
    if watching.tried:
        terminalreporter.write_line(f"{watching.tried.total()} examples")
