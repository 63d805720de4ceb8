"""A fleet of its own: one mind a robot, no server."""
