"""The `lta bag` verbs, one file each."""
