"""The light of a scene: lamps, what a room throws back, sky and mains, and who sees what."""
