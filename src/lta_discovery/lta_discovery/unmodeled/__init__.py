"""What is in no library: generic rivals, lines, and what remains, described."""
