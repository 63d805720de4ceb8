"""Random missions: settings and families by name."""
