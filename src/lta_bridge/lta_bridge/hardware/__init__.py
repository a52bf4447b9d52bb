"""Real drones on the desk: what hangs on this machine, how it is, and one motor."""
