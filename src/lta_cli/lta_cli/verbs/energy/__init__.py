"""`lta energy`: one file a command."""
