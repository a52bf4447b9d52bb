"""Interface to OpenFOAM: its input and output files, and its programs."""
