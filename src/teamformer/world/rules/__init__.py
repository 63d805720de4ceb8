"""Rules that simulator, planning and policies share; the referee has its own."""
