"""Descriptions of a drone and its scene for viewers: URDF, fixed frames, markers."""
