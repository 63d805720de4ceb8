"""How many examples are tried: the same few every day, other ones for `make fuzz`."""

from __future__ import annotations

from pathlib import Path

import hypothesis.internal.conjecture.providers as providers
import pytest
from hypothesis import HealthCheck, Phase, settings
from hypothesis.database import DirectoryBasedExampleDatabase

import watching

DATABASE = Path(__file__).parents[2] / "out" / "fuzz" / "examples"

COMMON = settings(
    deadline=None,
    phases=[Phase.explicit, Phase.reuse, Phase.generate, Phase.shrink],  # explaining is slow
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)
settings.register_profile("everyday", COMMON, derandomize=True, database=None)
settings.register_profile("fuzz", COMMON, database=DirectoryBasedExampleDatabase(DATABASE))
settings.load_profile("everyday")

# Hypothesis tries numbers and words out of our modules, too: out of those that happen to be
# imported by then. So the everyday examples would depend on which tests ran before.
NOTHING = providers.Constants()
assert hasattr(providers, "_get_local_constants")
providers._get_local_constants = lambda: NOTHING


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say how many examples were tried."""
    if watching.tried:
        terminalreporter.write_line(f"{watching.tried.total()} examples")
