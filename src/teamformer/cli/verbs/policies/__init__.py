"""Verbs on policies: list them, measure them, train them."""
