"""Analyse which effects flights can separate, and plan the next flight."""
