"""The rules of a step in plain Python; docs/explanation/step.md says the same in words."""
