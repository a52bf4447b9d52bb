"""Live view of a running graph in Foxglove: messages and a 3D scene."""
