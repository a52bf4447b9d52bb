"""Parse MCAP files, intact and damaged."""
