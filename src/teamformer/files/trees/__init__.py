"""Missions as the trees of their files: read with every mistake noted, and written."""
