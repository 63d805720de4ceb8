"""Changes of a plan as a graph: what each does, and for which problems it is."""
