"""Learned policies: features, actions and networks behind the seam, without torch."""
