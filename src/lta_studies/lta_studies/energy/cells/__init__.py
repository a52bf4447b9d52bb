"""Compare solar cells by the seed paper's criterion and a fair one, and build arrays."""
