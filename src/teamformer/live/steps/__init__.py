"""A live mission in steps: each incident has its past played again in the mission as it is now."""
