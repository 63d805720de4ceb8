"""Plans with forming counted: who does which task with whom, in what order."""
