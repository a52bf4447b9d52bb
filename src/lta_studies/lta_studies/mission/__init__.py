"""Simulate missions over days: charge on a perch, fly when light and reserve allow, return."""
