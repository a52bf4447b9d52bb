"""The `lta vehicle` verbs, one file each."""
