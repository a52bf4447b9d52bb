"""Find what a vehicle file lacks: the search of `posterior`, forecasts, conclusion, report."""
