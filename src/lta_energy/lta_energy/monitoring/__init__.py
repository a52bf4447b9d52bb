"""What a drone knows of its energy in flight, and what follows for the flight."""
