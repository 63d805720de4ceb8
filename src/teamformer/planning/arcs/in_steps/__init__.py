"""What is different for plans in steps: how robots meet, part and ride along."""
