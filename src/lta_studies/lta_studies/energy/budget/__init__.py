"""What each thing that the drone does takes, measured on flights, beside the seed paper."""
