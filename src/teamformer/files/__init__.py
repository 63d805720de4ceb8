"""Mission files, map importers and random scenarios."""
