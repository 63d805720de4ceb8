"""The rules of a step in plain code: what teams may do, where they walk, what is done."""
