"""Compare platforms: the same manoeuvres, each platform by its own control law."""
