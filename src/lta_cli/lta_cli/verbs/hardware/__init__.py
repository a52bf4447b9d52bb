"""`lta hardware`: one file a command."""
