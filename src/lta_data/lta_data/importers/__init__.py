"""Convert logs of other systems to bags."""
