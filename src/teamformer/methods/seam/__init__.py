"""What a policy is to those who play it, and what a user of one is told."""
