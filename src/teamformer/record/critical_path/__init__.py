"""What the end of a mission hangs on: the chain of ways, waits, services and forming before it."""
