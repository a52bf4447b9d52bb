"""`lta light`: one file a command."""
