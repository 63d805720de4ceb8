"""A mission that outlives its server: written down as it runs, and gone on with."""
