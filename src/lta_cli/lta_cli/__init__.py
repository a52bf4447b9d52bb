"""The `lta` command line: its verbs and the checks of the machine."""
