"""The `lta` command: its verbs, the checks of the machine and the pages of the reference."""
