"""The `lta hardware` verbs, one file each."""
