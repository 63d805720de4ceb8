"""Scenario files, map importers and random scenarios."""
