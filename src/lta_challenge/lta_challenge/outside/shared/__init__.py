"""Helpers shared by the kinds of forces outside the library."""
