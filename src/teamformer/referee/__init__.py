"""The referee: judges records by the rules alone, with none of the simulator's code."""

from teamformer.referee.judge import judge
from teamformer.referee.verdict import Finding, Verdict

__all__ = ["Finding", "Verdict", "judge"]
