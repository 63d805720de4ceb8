"""How teams go by plans that coordinators make: what is known, and what follows for each team."""
