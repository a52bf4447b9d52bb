"""Predictions some seconds ahead: how far off they are, and fits to them."""
