"""Records of fleets, whose steps are snapshots: how they are written."""
