"""The PettingZoo environment: one agent a robot."""
