"""The light board, emulated."""
