"""Compiled vehicle dynamics: one vehicle, many on a CPU, many on a GPU."""
