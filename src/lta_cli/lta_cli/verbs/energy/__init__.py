"""The `lta energy` verbs, one file each."""
