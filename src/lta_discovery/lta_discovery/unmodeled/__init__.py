"""Detect and describe forces outside the library: generic rivals, oscillations, remainders."""
