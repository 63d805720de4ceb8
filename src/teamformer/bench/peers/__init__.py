"""Solvers of others on the same missions in the same seconds, judged by our own times."""
