"""The link from a lamp to the photodiodes by distance: lux and signal-to-noise ratio."""
