"""Live view of a running graph in Foxglove."""
