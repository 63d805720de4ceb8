"""What is planned: tasks, kinds of robots, ways, prices, links; and what a plan is."""
