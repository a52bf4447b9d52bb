"""The spectrum of a light block: its bins, tones and noise."""
