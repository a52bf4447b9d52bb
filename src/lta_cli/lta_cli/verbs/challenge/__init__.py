"""`lta challenge`: one file a command."""
