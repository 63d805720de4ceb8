"""A mission that runs while it is watched, and to which incidents happen."""
