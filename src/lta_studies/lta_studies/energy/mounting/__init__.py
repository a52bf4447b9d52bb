"""Compare panel mounts: balance, swing, flight and light."""
