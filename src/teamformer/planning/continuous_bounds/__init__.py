"""Lower bounds on the makespan of a coalition problem."""
