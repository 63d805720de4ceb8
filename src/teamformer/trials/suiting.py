"""Which allocation a policy plays under: one that it was made for."""

from __future__ import annotations

from dataclasses import replace

from teamformer.errors import TeamformerError
from teamformer.model import Scenario
from teamformer.policies.protocol import MadeFor, Policy


def knows(policy: Policy, allocation: str) -> bool:
    """Say whether a policy was made for an allocation."""
    return not isinstance(policy, MadeFor) or allocation in policy.allocations


def suited(scenario: Scenario, policy: Policy) -> Scenario:
    """Return a scenario under an allocation that the policy was made for; its own, if it was."""
    if knows(policy, scenario.allocation):
        return scenario
    assert isinstance(policy, MadeFor)
    return replace(scenario, allocation=policy.allocations[0])


def refuse_unknown(policy: Policy, name: str, allocation: str | None) -> None:
    """Raise `TeamformerError` if a policy was not made for the allocation asked for."""
    if allocation is not None and isinstance(policy, MadeFor) and not knows(policy, allocation):
        made_for = " or ".join(policy.allocations)
        raise TeamformerError(
            f"policy '{name}' was made for allocation {made_for}, not {allocation}",
            f"leave --allocation out, or use {policy.allocations[0]}",
        )
