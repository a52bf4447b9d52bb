"""Readings that cannot be believed: one file a fault, and the watch over all of them."""
