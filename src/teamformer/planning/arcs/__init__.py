"""Plans as graphs of arcs between tasks: the search for missions of any size."""
