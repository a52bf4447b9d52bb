"""What the drone decides: estimation, cascaded control, allocation and navigation."""
