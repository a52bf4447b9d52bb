"""What an outside tracker says of the drone: sieved, placed, dated, and with its motion."""
