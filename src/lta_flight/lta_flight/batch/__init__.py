"""Fly thousands of closed loops at once, with one source for CPU cores and GPU."""
