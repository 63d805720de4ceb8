"""Annealing over orders and coalitions: where it stands, what it changes, how it judges."""
