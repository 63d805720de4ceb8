"""What missions are made of: worlds, places, capabilities, and who can be where."""
