"""What a node says when it is started with `--help`."""
