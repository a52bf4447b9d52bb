"""The verbs of the lta command, one file each."""
