"""Plans of tasks whose starts are linked, and plans that are judged by a cost of their own."""
