"""Scripted policies: the paper's heuristic and the rules that are harder to beat."""
