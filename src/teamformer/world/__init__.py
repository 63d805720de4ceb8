"""The Team Formation Environment: exact steps, views, rewards and records."""
