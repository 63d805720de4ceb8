"""What is left of a mission in continuous time as a problem in ticks, and as a clock."""
