"""Demodulate modulated light (VLC) and estimate the bearing and position of a lamp."""
