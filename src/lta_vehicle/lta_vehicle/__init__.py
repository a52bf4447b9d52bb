"""Describe, validate and compare vehicle files, and estimate heaviness from a flight."""
