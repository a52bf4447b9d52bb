"""Studies: light, energy, missions, wind, tuning, platforms, wind tunnel and the seed paper."""
