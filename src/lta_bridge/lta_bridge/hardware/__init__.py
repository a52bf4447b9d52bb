"""Real drones on the desk: what hangs on this machine, how it is, one motor, and the turntable."""
