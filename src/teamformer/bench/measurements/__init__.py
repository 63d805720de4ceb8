"""Measurements that are no trials in rows: speed, caching, anytime curves."""
