"""Compare navigation strategies over scenes and seeds, and with the paper."""
