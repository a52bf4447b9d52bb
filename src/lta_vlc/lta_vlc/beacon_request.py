"""What is asked for on `light/beacon`: known without loading what hears it."""

NO_WISH = 0.0  # Hz, of a wanted beacon: the first of the settings
