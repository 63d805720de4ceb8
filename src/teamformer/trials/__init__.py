"""Trials: one mission, one method, one seed, run to its end and recorded."""
