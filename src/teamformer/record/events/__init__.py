"""What the events of a record in continuous time come to: where robots were, what they did, why."""
