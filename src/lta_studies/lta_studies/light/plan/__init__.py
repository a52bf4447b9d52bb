"""Where lamps go on a floor, and at what frequencies, so that a drone hears one everywhere."""
