"""The record of a trial, and its file (docs/replay.md)."""
