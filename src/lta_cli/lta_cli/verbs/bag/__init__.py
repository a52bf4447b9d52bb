"""`lta bag`: one file a command."""
