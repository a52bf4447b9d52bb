"""The `lta cfd` verbs, one file each."""
