"""Prepare measured flights: read, check, resample to one grid, cut into pieces."""
