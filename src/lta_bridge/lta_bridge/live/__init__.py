"""A running graph as Foxglove sees it: which messages are shown, and the scene around them."""
