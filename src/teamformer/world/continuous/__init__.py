"""Missions in continuous time as they really happen: one world, its events, who obeys a plan."""
