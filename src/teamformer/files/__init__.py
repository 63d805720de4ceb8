"""Mission files, map importers and random missions."""
