"""When everything in a plan in steps really happens: rule by rule, as it is played."""
