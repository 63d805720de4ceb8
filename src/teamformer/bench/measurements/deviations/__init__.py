"""What one deviation from the shared plan gains in missions with surprises, and who can tell."""
