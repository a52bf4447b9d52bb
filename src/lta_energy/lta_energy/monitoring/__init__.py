"""Estimate the energy state in flight and monitor the reserve."""
