"""Where the panels sit: balance, swing, flight and light of each mount."""
