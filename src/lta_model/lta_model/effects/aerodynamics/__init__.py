"""Drag, damping, lift and the air that moves with the hull."""
