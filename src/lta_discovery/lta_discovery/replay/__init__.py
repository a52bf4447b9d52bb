"""Flights through the model: what it predicts, and how that answers to everything."""
