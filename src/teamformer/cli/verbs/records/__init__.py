"""Verbs on the record of a trial."""
