"""Figures derived from a vehicle file: mass, balance, thrust, speed, stability and helium."""
