"""Propose a mapping for a log from the names and the physics of its columns."""
