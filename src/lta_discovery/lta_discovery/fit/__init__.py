"""Estimate parameters and their evidence from flights."""
