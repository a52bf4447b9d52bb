"""Simulate cases of the row `other`, sharing no code and no equations with the model."""
