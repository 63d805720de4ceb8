"""Verbs on a mission: write one, run it, plan it, watch it."""
