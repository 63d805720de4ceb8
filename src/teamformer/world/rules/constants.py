"""Numbers that mean the same wherever they stand."""

from teamformer.mission.parts.plane import DECIMALS

NOBODY = -1
"""No robot, no team, no task."""

FAR = 2**28
"""More steps than anything takes: the time to a place that cannot be reached, or never."""

NEVER = 2**30
"""A step that never comes: of what is not lost, not back, not known."""

ROUNDING = 1e-9
"""Speeds are binary fractions: ten steps at 0.1 must make one cell."""

MICROMETRES = 10.0**DECIMALS
"""In a metre: places on a plane are kept to whole ones, in every step."""
