"""A mission that is drawn: its file with comments, and what is wrong with it."""
