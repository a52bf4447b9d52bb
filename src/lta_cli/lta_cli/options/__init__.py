"""Options that many commands share, and the console that they print on."""
