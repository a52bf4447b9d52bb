"""`lta cfd`: one file a command."""
