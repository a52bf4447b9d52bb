"""Errors of sensors, of the tracker and of clocks."""
