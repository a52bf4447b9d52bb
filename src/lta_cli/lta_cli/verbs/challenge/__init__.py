"""The `lta challenge` verbs, one file each."""
