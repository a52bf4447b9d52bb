"""Measured flights: read, believed or cut, on one grid, in pieces."""
