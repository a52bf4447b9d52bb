"""`lta vehicle`: one file a command."""
