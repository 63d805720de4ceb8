"""What plans may say, when they are made, and whether teams go by them."""
