"""The record of a trial, and its file (docs/reference/record.md)."""
