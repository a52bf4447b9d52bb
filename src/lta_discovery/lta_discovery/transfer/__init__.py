"""Names by forecasts: what carries over to regimes that were left out of the fit."""
