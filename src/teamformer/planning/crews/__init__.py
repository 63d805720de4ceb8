"""Crews: standing parts of a fleet, each with its own list of tasks."""
