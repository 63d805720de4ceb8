"""What everything else stands on: errors, files whole in and out, code of users, processes."""
