"""Agents under faults: a network and bodies that one seed determines, and a checker."""
