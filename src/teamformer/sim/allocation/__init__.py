"""Which task a team heads for: shared orders, crews and the rules along them."""
