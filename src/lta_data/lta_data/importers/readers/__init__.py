"""Readers of the formats of others."""
