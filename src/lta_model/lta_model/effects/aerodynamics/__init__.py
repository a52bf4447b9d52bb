"""Drag, damping, lift and added mass."""
