"""Demonstrate discovery: hide an effect, fly with it, and find it."""
