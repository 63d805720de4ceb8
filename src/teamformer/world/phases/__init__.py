"""The phases of a step: who parts and joins, who walks, what is done, found and lost."""
