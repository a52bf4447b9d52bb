"""What `lta light` does: the light link seen from the ground."""
