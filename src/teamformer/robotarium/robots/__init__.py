"""Robots to drive: a simulated plant, the official simulator, the testbed."""
