"""Compile plain Python functions with numba, and cache them by their source."""
