"""What was found, written: for programs, for the vehicle, for Foxglove, on the terminal."""
