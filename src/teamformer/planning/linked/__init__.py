"""The search where starts of tasks are linked, or plans are judged by a cost of their own."""
