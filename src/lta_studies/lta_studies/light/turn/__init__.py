"""Calibrate the photodiodes of a real light board by a turn in front of a lamp."""
