"""Define the values of `light/beacon`, without importing the receiver."""

NO_WISH = 0.0  # Hz, of a wanted beacon: the first of the settings
