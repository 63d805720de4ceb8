"""Rules that simulator, planning and policies share; the reference step has its own."""
