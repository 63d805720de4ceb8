"""Trials: one scenario, one policy, one seed, run to its end and recorded."""
