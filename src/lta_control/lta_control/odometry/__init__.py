"""Estimate speed and position: through the air, and over ground."""
