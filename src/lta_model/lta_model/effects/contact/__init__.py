"""Forces of floor, walls and ceiling."""
