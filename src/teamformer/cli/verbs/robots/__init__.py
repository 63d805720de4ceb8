"""Verbs on robots of their own, and on what comes near them: fleets, rehearsals, the Robotarium."""
