"""Compare platforms in the same manoeuvres, each with its own control law."""
