"""Plans where not everything is known: played in sampled futures, the best on average is taken."""
