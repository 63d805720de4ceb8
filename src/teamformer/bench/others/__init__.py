"""Other people's instances by their own rules, beside what is published of them."""
