"""Something is hidden, flown, found, added and shown."""
