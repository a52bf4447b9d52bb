"""What the light says: demodulation of a flickering lamp and its bearing."""
