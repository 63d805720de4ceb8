"""What is told of a record: its parts, and the trees of files and messages that bring them."""
