"""The flat folder for the testbed, and what runs networks there with NumPy alone."""
