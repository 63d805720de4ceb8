"""What moves: simulated robots, automated guided vehicles, robots of the user."""
