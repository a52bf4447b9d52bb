"""Plan lamp positions and frequencies so that a drone receives a lamp everywhere."""
