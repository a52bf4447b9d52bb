"""Navigation strategies compared over scenes and seeds, and beside the paper."""
