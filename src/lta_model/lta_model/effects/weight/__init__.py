"""Mass, its distribution, and the lift of the gas."""
