"""First plans: who can be there first does it."""
