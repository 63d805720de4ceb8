"""The keys of the mission file, each declared once: for those that read, write and explain it."""
