"""Checks for those who write methods and bodies: that they keep what the seams promise.

Each raises `AssertionError` with a sentence that says what is promised and what came instead.
"""

from teamformer.testing.bodies import check_body
from teamformer.testing.coordinators import check_coordinator
from teamformer.testing.policies import check_policy

__all__ = ["check_body", "check_coordinator", "check_policy"]
