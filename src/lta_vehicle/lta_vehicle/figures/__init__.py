"""The figures that follow from a vehicle file."""
