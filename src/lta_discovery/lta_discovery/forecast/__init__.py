"""Compute prediction errors some seconds ahead, and fit parameters to them."""
