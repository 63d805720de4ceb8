"""Who decides which robots do which task together: the seam is `coordination.Coordinator`."""
