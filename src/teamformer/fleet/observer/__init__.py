"""A page that watches a running fleet, and adds tasks to it."""
