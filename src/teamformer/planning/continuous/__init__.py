"""Plans as an order of tasks and a coalition for each, in continuous time."""
