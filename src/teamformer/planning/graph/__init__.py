"""A plan as a graph of arcs between tasks, its times, and how a change is judged."""
