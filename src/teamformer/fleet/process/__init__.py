"""Agents as processes: the loop of one, its facts file, and a whole fleet on one machine."""
