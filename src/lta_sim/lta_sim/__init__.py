"""Simulation of the world: vehicle, physical effects, light field and sensors."""
