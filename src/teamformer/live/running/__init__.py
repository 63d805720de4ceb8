"""A mission that runs: what happens to it, how it may end, and what pages are told of it."""
