"""Tells a record once: services, what each robot did and why, and the critical path."""
