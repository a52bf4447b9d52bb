"""The verbs of `lta cluster`, and the options that they share."""
