"""What a mission may ask for, and what makes one impossible."""
