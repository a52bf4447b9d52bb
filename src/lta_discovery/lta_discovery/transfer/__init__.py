"""Identify effects by forecasts that transfer to regimes left out of the fit."""
