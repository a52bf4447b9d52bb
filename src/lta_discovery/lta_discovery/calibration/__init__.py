"""Calibrate a vehicle from its flights: what every vehicle file must state."""
