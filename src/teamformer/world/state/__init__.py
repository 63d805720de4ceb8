"""A batch of worlds as arrays, and the lists that kernels keep of them."""
