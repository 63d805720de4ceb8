"""Lower bounds: what no plan and no policy can beat."""
