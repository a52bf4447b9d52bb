"""Replay flights through the model: predictions and their sensitivities."""
