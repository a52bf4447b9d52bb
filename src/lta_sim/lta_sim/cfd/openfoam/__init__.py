"""OpenFOAM: its files and its programs."""
