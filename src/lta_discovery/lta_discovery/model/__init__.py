"""Represent a vehicle by its parameters and compile its effects for the replay."""
