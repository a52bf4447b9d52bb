"""What the kinds of forces share."""
