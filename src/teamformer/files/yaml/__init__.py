"""YAML and JSON as trees that know their lines, both ways."""
