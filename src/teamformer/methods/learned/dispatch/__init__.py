"""A network that gives out tasks: what is on offer, what it sees of that, and the plan it makes."""
