"""The `lta light` verbs, one file each."""
