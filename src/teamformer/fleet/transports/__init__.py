"""How messages get from one robot to another."""
