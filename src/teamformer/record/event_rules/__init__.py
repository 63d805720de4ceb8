"""The rules of continuous time by which the referee follows events; nothing of the world's code."""
