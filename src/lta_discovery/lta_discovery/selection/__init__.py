"""Select the missing effects: search, evidence, and acceptance."""
