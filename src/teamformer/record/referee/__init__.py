"""The referee: judges records by the rules alone, with none of the simulator's code."""

from teamformer.record.referee.judge import judge
from teamformer.record.referee.rules.verdict import Finding, Verdict

__all__ = ["Finding", "Verdict", "judge"]
