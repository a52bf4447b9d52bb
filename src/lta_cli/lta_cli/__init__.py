"""The `lta` command line: its verbs, the machine checks and the reference pages."""
