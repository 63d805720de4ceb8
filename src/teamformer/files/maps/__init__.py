"""Maps that others have made."""
