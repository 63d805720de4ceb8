"""What is impossible in a mission, found when one is made; each with what to do."""
