"""Records of rehearsals, made of what a trace holds."""
