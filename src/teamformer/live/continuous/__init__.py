"""A live mission in continuous time: its present is forked, and goes on under another truth."""
