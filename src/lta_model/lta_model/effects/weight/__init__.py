"""Mass, its place, and the lift of the gas."""
