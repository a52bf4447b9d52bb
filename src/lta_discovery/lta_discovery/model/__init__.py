"""A vehicle as numbers: what can be turned about it, and its effects compiled."""
