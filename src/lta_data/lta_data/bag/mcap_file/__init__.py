"""MCAP files, byte by byte, whole and damaged."""
