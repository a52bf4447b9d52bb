"""Which effects are missing: the search, its evidence, and what a name has to stand."""
