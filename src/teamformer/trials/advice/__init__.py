"""What would help a mission most, measured by planning it again with one thing changed."""
