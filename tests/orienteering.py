"""A small instance of team orienteering: two paths of 10, from (1, 1) to (4, 1)."""

CHAO = "n 5\nm 2\ntmax 10\n1 1 0\n4 1 7\n1 5 5\n9 9 20\n4 1 0\n"
"""t1 is at the end, t2 4 + 5 away from both, t3 too far off."""
