"""Who is due where by crews and plans, what teams pursue, when plans are made and why."""
