"""What teams are due to do by plans, what they pursue, when plans are made and why."""
