"""Compiled vehicle dynamics: one vehicle, and each of many on a CPU or a GPU."""
