"""Numbers that mean the same for all problems in ticks."""

NEVER = 2**60
"""A moment that does not come; ticks of real times stay far below."""

SPREAD = 20
"""The mean time at which robots are home weighs this many times less than the last one."""

TICKS = 1024
"""Ticks of a step, where missions in steps are planned; a power of two."""
