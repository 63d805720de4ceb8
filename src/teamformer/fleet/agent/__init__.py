"""The mind of one robot: a state machine without input or output of its own."""
