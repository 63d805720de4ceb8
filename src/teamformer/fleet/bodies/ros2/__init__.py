"""Bodies in a ROS 2 graph: who is meant, where it is, how it is sent off, and what RViz shows."""
