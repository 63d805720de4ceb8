"""The referee: judges records by the reference step, with none of the simulator's kernels."""

from teamformer.record.referee.judge import judge
from teamformer.record.referee.verdict import Finding, Verdict

__all__ = ["Finding", "Verdict", "judge"]
