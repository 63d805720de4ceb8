"""The central planner: knows everything, plans first, then plays its plan."""
