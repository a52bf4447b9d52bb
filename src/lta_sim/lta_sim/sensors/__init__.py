"""What the sensors report of the true state of the world."""
