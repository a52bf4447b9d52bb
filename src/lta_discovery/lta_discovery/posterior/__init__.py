"""Find what a vehicle file lacks: one posterior over models of the flights."""
