"""The search for plans as graphs of arcs, for missions of any size and kind."""
