"""Locate discrepancies between the model of the vehicle file and the flights."""
