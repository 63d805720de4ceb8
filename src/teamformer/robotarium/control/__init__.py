"""Where real robots go and how they get there safely."""
