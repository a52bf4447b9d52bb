"""Commands of `lta tests`."""
