"""Evaluate a real light board on a turntable in front of a lamp."""
