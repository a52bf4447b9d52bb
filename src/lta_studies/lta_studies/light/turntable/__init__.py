"""A real light board on a turntable before a lamp."""
